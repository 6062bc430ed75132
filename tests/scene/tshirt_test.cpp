// A garment that nobody here made: it loads, gets springs, and hangs by its shoulders.

#include <gtest/gtest.h>

#include "taut/io/obj.h"
#include "taut/mesh/topology.h"
#include "taut/scene/scene_file.h"
#include "taut/scene/scene_simulation.h"
#include "taut/sim/cloth_model.h"
#include "taut/step/state.h"
#include "test_data.h"

namespace taut {
namespace {

// The highest vertex whose x lies between these, cm.
Index shoulder(const TriangleMesh& shirt, double from, double to) {
  Index highest = -1;
  for (Index i = 0; i < static_cast<Index>(shirt.positions.size()); ++i) {
    const Vec3& p = shirt.positions[i];
    if (p.x() >= from && p.x() <= to && (highest < 0 || p.y() > shirt.positions[highest].y()))
      highest = i;
  }
  return highest;
}

// 0.2 kg/m² is a T-shirt's jersey. Springs of 2000 N/m on edges of 2 cm are a fabric of some 2
// kN/m, as woven cotton: each shoulder bears half of the shirt's weight, about 1 N, mostly on one
// or two edges. compression = "linear": the mesh has no shear springs, and an edge that gives way
// in compression would let its triangles fold flat under the pins; a knitted shirt that fine does
// push back over 2 cm.
constexpr const char* scene_text = R"(
[time]
step = 5e-3
[solver]
name = "mpcg"
[[cloth]]
name = "shirt"
mesh = "SHIRT"
scale = 0.01
up = "y"
density = 0.2
k_stretch = 2000
k_bend = 0.05
compression = "linear"
drag = 2e-5
[[cloth.pin]]
nodes = [LEFT, RIGHT]
)";

std::string filled(std::string text,
                   const std::vector<std::pair<std::string, std::string>>& values) {
  for (const auto& [name, value] : values) text.replace(text.find(name), name.size(), value);
  return text;
}

TEST(TShirt, HangsByItsShoulders) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "no ../shared/data";
  const std::filesystem::path path = *data / "tshirt" / "tshirt.obj";
  const TriangleMesh shirt = read_obj(path);
  const Topology topology = build_topology(shirt);
  const Index left = shoulder(shirt, -18, -14), right = shoulder(shirt, 14, 18);
  SceneSimulation simulation(read_scene_text(filled(scene_text, {{"SHIRT", path.string()},
                                                                 {"LEFT", std::to_string(left)},
                                                                 {"RIGHT", std::to_string(right)}}),
                                             "/scenes/tshirt.toml"));

  const auto& springs = simulation.cloth().springs();
  ASSERT_EQ(springs.size(), 2u);
  EXPECT_EQ(springs[0]->springs().size(), topology.edges.size());
  EXPECT_EQ(springs[1]->springs().size(), topology.hinges.size());
  const std::vector<Vec3> start = simulation.state().x;
  ASSERT_EQ(start.size(), 2799u);
  EXPECT_NEAR(start[left].z(), 0.01 * shirt.positions[left].y(), 1e-12)
      << "Y up became Z up, centimetres metres";
  double mass = 0.0, area = 0.0;
  for (const double m : simulation.cloth().external().masses()) mass += m;
  for (Index t = 0; t < static_cast<Index>(shirt.triangles.size()); ++t)
    area += triangle_area(shirt, t);
  EXPECT_NEAR(mass, 0.2 * 1e-4 * area, 1e-12);

  const auto lowest = [&] {
    double z = 1e9;
    for (const Vec3& p : simulation.state().x) z = std::min(z, p.z());
    return z;
  };
  const double hem = lowest();
  StepReport record;
  double stretch = 0.0;
  for (int k = 0; k < 100; ++k) {
    ASSERT_TRUE(simulation.step(record).ok());
    stretch = std::max(stretch, record.max_stretch);
    ASSERT_EQ(record.fallbacks, 0);
    ASSERT_EQ(record.collapsed_springs, 0);
  }
  EXPECT_LT(stretch, 0.2);
  EXPECT_GT(stretch, 0.001) << "it hangs: its pins are felt";
  for (const Index pin : {left, right})
    EXPECT_LT((simulation.state().x[pin] - start[pin]).norm(), 1e-12);
  // It hangs below the pins, neither fallen off nor drawn out.
  EXPECT_GT(lowest(), hem - 0.15);
  double middle = 0.0;
  for (const Vec3& p : simulation.state().x) middle += p.z() / 2799.0;
  EXPECT_LT(middle, start[left].z() - 0.2);
}

}  // namespace
}  // namespace taut
