// Solids from meshes: where they are at a time, and cloth that lands on them.

#include "taut/sim/mesh_solid.h"

#include <gtest/gtest.h>

#include "io/temporary_folder.h"
#include "taut/base/error.h"
#include "taut/io/obj.h"
#include "taut/io/pc2.h"
#include "taut/scene/scene_file.h"
#include "taut/scene/scene_simulation.h"
#include "taut/step/state.h"

namespace taut {
namespace {

const TriangleMesh wedge{
    {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {0, 0, 6}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}, {}};

Vec3 vertex_at(const MeshSolid& solid, double time, std::size_t vertex) {
  std::vector<Vec3> x(static_cast<std::size_t>(solid.vertices()));
  solid.positions(time, x);
  return x[vertex];
}

TEST(MeshSolid, IsScaledTurnedAndCarried) {
  const test::TemporaryFolder folder;
  write_obj(folder / "wedge.obj", wedge);
  SolidEntry solid;
  solid.shape = SolidShape::mesh;
  solid.mesh = "wedge.obj";
  solid.scale = 0.5, solid.y_up = true;
  solid.initial.translation = Vec3(1, 0, 0), solid.velocity = Vec3(0, 0, 2);
  const MeshSolid placed(solid, read_surface(solid, folder / ""));
  EXPECT_EQ(vertex_at(placed, 0.0, 2), Vec3(1, 0, 2)) << "y up becomes z up";
  EXPECT_EQ(vertex_at(placed, 0.5, 2), Vec3(1, 0, 3));
  EXPECT_EQ(vertex_at(placed, 0.0, 3), Vec3(1, -3, 0));
}

TEST(MeshSolid, FollowsItsSamples) {
  const test::TemporaryFolder folder;
  write_obj(folder / "wedge.obj", wedge);
  Pc2Writer writer(folder / "wedge.pc2", 4);
  std::vector<Vec3> x = wedge.positions;
  for (int k = 0; k < 3; ++k) {
    x[3].z() = 6.0 + k;
    writer.add_sample(x);
  }
  writer.finish();
  SolidEntry solid;
  solid.shape = SolidShape::mesh;
  solid.mesh = "wedge.obj", solid.motion = "wedge.pc2", solid.motion_rate = 10.0;
  const MeshSolid deforming(solid, read_surface(solid, folder / ""));
  for (const auto& [time, z] : {std::pair(-1.0, 6.0),
                                {0.0, 6.0},
                                {0.05, 6.5},
                                {0.1, 7.0},
                                {0.175, 7.75},
                                {0.2, 8.0},
                                {9.0, 8.0}})
    EXPECT_NEAR(vertex_at(deforming, time, 3).z(), z, 1e-12) << time;
}

TEST(MeshSolid, ClothRestsOnAMeshAndIsNotThroughIt) {
  const test::TemporaryFolder folder;
  const double s = 0.5;
  write_obj(folder / "table.obj",
            {{{-s, -s, 0}, {s, -s, 0}, {s, s, 0}, {-s, s, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}});
  const std::string text = R"(
[time]
step = 5e-3
[[cloth]]
grid = { nodes = [9, 9], origin = [-0.2, -0.2, 0.02], u = [0.4, 0, 0], v = [0, 0.4, 0] }
density = 0.15
velocity = [0.5, 0, 0]
[[solid]]
name = "table"
shape = "mesh"
mesh = "table.obj"
friction = 0.5
thickness = 2e-3
)";
  SceneSimulation simulation(read_scene_text(text, (folder / "scene.toml").string(), {}));
  StepReport record;
  for (int k = 0; k < 120; ++k) {
    ASSERT_TRUE(simulation.step(record).ok());
    ASSERT_EQ(record.intersections, 0);
  }
  EXPECT_GT(record.pushing_pairs, 40);
  EXPECT_LT(record.kinetic_J, 1e-6) << "friction has stopped it";
  double slid = 0.0;
  for (const Vec3& x : simulation.state().x) {
    EXPECT_NEAR(x.z(), 2e-3, 1e-3);
    slid += x.x() / 81;
  }
  // 0.064 s of falling at 0.5 m/s, then v²/(2 mu g), plus what landing adds to the pressure: it
  // stops earlier.
  EXPECT_GT(slid, 0.5 * 0.06);
  EXPECT_LT(slid, 0.5 * 0.065 + 0.5 * 0.5 / (2 * 0.5 * 9.81) + 0.005);
}

TEST(MeshSolid, AMissingFileIsNamed) {
  SolidEntry solid;
  solid.name = "body";
  solid.shape = SolidShape::mesh;
  solid.mesh = "nowhere.obj";
  try {
    read_surface(solid, "/scenes");
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/scenes/nowhere.obj"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace taut
