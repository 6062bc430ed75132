// What is recorded of contact at each node, against where the nodes are, and that it does not
// depend on threads or on a resume.

#include "taut/sim/node_contact.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "io/temporary_folder.h"
#include "taut/base/parallel.h"
#include "taut/contact/solid_contact.h"
#include "taut/io/obj.h"
#include "taut/scene/scene_file.h"
#include "taut/scene/scene_simulation.h"
#include "taut/sim/surface_contact.h"
#include "taut/step/state.h"
#include "taut/step/stepper.h"

namespace taut {
namespace {

Scene scene_of(const std::string& text, const std::string& folder = "") {
  return read_scene_text("[time]\nstep = 5e-3\n" + text, folder + "scene.toml", {});
}

void advance(SceneSimulation& simulation, int steps) {
  StepReport record;
  for (int k = 0; k < steps; ++k) ASSERT_TRUE(simulation.step(record).ok());
}

const std::string sheet = R"(
[[cloth]]
name = "lower"
grid = { nodes = [9, 9], origin = [-0.2, -0.2, 0.02], u = [0.4, 0, 0], v = [0, 0.4, 0] }
density = 0.15
)";

TEST(NodeContact, IsWhereClothTouchesTheBall) {
  SceneSimulation simulation(scene_of(R"(
[[cloth]]
grid = { nodes = [31, 31], origin = [-0.5, -0.5, 0.42], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.15
k_stretch = 500
[[solid]]
shape = "sphere"
radius = 0.4
friction = 0.5
thickness = 0.01
)"));
  for (const std::uint8_t bits : node_contact(simulation))
    ASSERT_EQ(bits, 0) << "before the first step";
  advance(simulation, 60);
  const std::vector<std::uint8_t> contact = node_contact(simulation);
  int touching = 0, near = 0;
  for (std::size_t i = 0; i < contact.size(); ++i) {
    const double gap = simulation.state().x[i].norm() - 0.41;
    touching += contact[i] != 0;
    EXPECT_EQ(contact[i] & ~touches_solid, 0) << "there is only a ball";
    if (contact[i]) {
      EXPECT_LT(std::abs(gap), 1e-3) << i;
    } else {
      EXPECT_GT(gap, -1e-9) << i;
      near += gap < 1e-6;  // let go in this step, or about to touch
    }
  }
  EXPECT_LE(near, 3);
  EXPECT_GT(touching, 50);
  EXPECT_LT(touching, 900);
}

TEST(NodeContact, TellsClothFromSolids) {
  SceneSimulation simulation(scene_of(sheet + R"(
[[cloth]]
name = "upper"
grid = { nodes = [9, 9], origin = [-0.11, -0.11, 0.04], u = [0.2, 0, 0], v = [0, 0.2, 0] }
density = 0.15
[[solid]]
shape = "plane"
friction = 0.5
[contact]
self = true
)"));
  advance(simulation, 120);
  const std::vector<std::uint8_t> contact = node_contact(simulation);
  int below = 0, above = 0;
  for (int i = 0; i < 81; ++i) {
    EXPECT_TRUE(contact[i] & touches_solid) << "lower sheet, node " << i;
    below += (contact[i] & touches_cloth) != 0;
  }
  for (int i = 81; i < 162; ++i) {
    EXPECT_FALSE(contact[i] & touches_solid) << "upper sheet, node " << i;
    above += (contact[i] & touches_cloth) != 0;
  }
  EXPECT_GT(above, 60) << "it lies on the lower sheet";
  EXPECT_GT(below, 20);
  EXPECT_LT(below, 50) << "the upper sheet covers a quarter of the lower";
}

TEST(NodeContact, KnowsSolidsThatAreMeshes) {
  const test::TemporaryFolder folder;
  const double s = 0.5;
  write_obj(folder / "table.obj",
            {{{-s, -s, 0}, {s, -s, 0}, {s, s, 0}, {-s, s, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}});
  SceneSimulation simulation(
      scene_of(sheet + "[[solid]]\nshape = \"mesh\"\nmesh = \"table.obj\"\nfriction = 0.5\n",
               (folder / "").string()));
  advance(simulation, 3);
  for (const std::uint8_t bits : node_contact(simulation)) ASSERT_EQ(bits, 0) << "still falling";
  advance(simulation, 117);
  for (const std::uint8_t bits : node_contact(simulation)) EXPECT_EQ(bits, touches_solid);
}

TEST(NodeContact, SameForAnyNumberOfThreadsAndAfterAResume) {
  // With no impulses at all, everything that collides is a zone.
  const std::vector<std::string> settings{"cloth.grid.nodes=[17,17]", "contact.sweeps=0"};
  const Scene scene = read_scene(std::string(TAUT_SOURCE_DIR) + "/scenes/clump.toml", settings);
  const int usual = thread_count();
  constexpr int steps = 160, interrupted = 60;
  std::vector<std::vector<std::uint8_t>> one;
  std::uint8_t seen = 0;
  for (const int threads : {1, 4}) {
    set_thread_count(threads);
    SceneSimulation simulation(scene), resumed(scene);
    for (int k = 1; k <= steps; ++k) {
      advance(simulation, 1);
      if (k > interrupted) advance(resumed, 1);
      if (k == interrupted) resumed.load(simulation.save());
      const std::vector<std::uint8_t> contact = node_contact(simulation);
      for (const std::uint8_t bits : contact) seen |= bits;
      if (threads == 1) one.push_back(contact);
      ASSERT_EQ(contact, one[static_cast<std::size_t>(k) - 1]) << "step " << k;
      if (k > interrupted) {
        ASSERT_EQ(node_contact(resumed), contact) << "resumed, step " << k;
      }
    }
  }
  set_thread_count(usual);
  EXPECT_EQ(seen, touches_solid | touches_cloth | held_in_zone)
      << "the test does not see all there is";
}

}  // namespace
}  // namespace taut
