// Scenes that start intersecting, repaired by contact.untangle: CGAL finds nothing left, and the
// run goes on from there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact/independent_judge.h"
#include "io/temporary_folder.h"
#include "scene/tangled_scenes.h"
#include "taut/base/error.h"
#include "taut/contact/solid_contact.h"
#include "taut/io/obj.h"
#include "taut/scene/scene_file.h"
#include "taut/scene/scene_simulation.h"
#include "taut/scene/scene_world.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/surface_contact.h"
#include "taut/step/state.h"

namespace taut {
namespace {

std::size_t judged(const SceneSimulation& simulation) {
  const SurfaceContact& contact = *simulation.surface_contact();
  const CollisionSurface& surface = contact.contact().surface();
  return test::intersecting_triangles(contact.positions(0.0, simulation.state().x),
                                      surface.triangles, surface.is_solid)
      .size();
}

std::size_t judged_unrepaired(Scene scene) {
  scene.contact.untangle = false;
  scene.contact.allow_intersections = true;
  return judged(SceneSimulation(std::move(scene)));
}

// The shipped T-shirt laid flat: its front and back 6 mm apart, less towards the seams; jittered so
// that they go through each other.
class FlatShirt : public testing::Test {
 protected:
  FlatShirt() {
    TriangleMesh shirt = read_obj(TAUT_SOURCE_DIR "/scenes/meshes/tshirt.obj");
    for (Vec3& p : shirt.positions) p.z() *= 0.1;
    write_obj(file_, shirt);
  }

  Scene scene(unsigned seed) const {
    const std::string text = R"(
[time]
step = 4e-3
[contact]
untangle = true
[[cloth]]
name = "shirt"
mesh = "SHIRT"
density = 0.15
k_stretch = 1000
k_shear = 0.5
k_bend = 0.02
jitter = 2e-3
)";
    return read_scene_text(std::string(text).replace(text.find("SHIRT"), 5, file_.string()),
                           "/scenes/test.toml",
                           std::vector<std::string>{"cloth.jitter_seed=" + std::to_string(seed)});
  }

 private:
  const test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "shirt.obj";
};

TEST_F(FlatShirt, IsDrawnApartAndRuns) {
  if (!test::judge_available()) GTEST_SKIP() << test::no_judge;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    ASSERT_GT(judged_unrepaired(scene(seed)), 10u);
    SceneSimulation simulation(scene(seed));
    const UntangleReport& report = *simulation.surface_contact()->untangled();
    EXPECT_EQ(judged(simulation), 0u);
    EXPECT_EQ(simulation.cloth().start().x, simulation.state().x);
    EXPECT_EQ(simulation.cloth().surface().positions, simulation.state().x);
    EXPECT_LE(report.stretch_after, report.stretch_before + 0.03);
    StepReport record;
    for (int k = 0; k < (seed > 2 ? 0 : 3); ++k) {
      ASSERT_TRUE(simulation.step(record).ok());
      EXPECT_EQ(record.intersections, 0);
    }
  }
}

TEST(UntangleScene, WhatCannotBeDrawnApartIsRefusedWithItsFaces) {
  try {
    SceneSimulation simulation(read_scene_text(test::pierced_scene(), "/scenes/test.toml",
                                               std::vector<std::string>{"contact.untangle=true"}));
    FAIL() << "not refused";
  } catch (const InputError& error) {
    const std::string text = error.what();
    for (const char* part : {"cannot be drawn apart", "are left after", "cloth 'strip'",
                             "cloth 'sheet'", "the triangle", "Nothing was changed"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

TEST(UntangleScene, PinnedNodesStayWhereTheirPinsAre) {
  const std::string text =
      test::slipped_scene("jitter = 1e-3\npin = [{ corners = [\"u0v0\", \"u1v0\"] }]\n");
  const Scene scene =
      read_scene_text(text, "/scenes/test.toml", std::vector<std::string>{"contact.untangle=true"});
  const ClothModel before(make_world(scene).world);
  SceneSimulation simulation(scene);
  const UntangleReport& report = *simulation.surface_contact()->untangled();
  EXPECT_GT(report.intersections_before, 0);
  EXPECT_GT(report.moved, 20);
  for (const Index pinned : {0, 14})
    EXPECT_EQ(simulation.state().x[pinned], before.start().x[pinned]);
  StepReport record;
  ASSERT_TRUE(simulation.step(record).ok());
  for (const Index pinned : {0, 14})
    EXPECT_LT((simulation.state().x[pinned] - before.start().x[pinned]).norm(), 1e-12);
}

}  // namespace
}  // namespace taut
