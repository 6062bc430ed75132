// --set key=value: what it changes, and how it is refused.

#include <gtest/gtest.h>

#include "taut/base/error.h"
#include "taut/scene/scene_file.h"

namespace taut {
namespace {

const std::string two_of_each = R"(
[time]
step = 1e-3
[[cloth]]
name = "a"
grid = { nodes = [5, 5], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.2
k_stretch = 100
[[cloth.pin]]
corners = ["u0v0"]
[[cloth.pin]]
corners = ["u1v0"]
[[cloth]]
name = "b"
grid = { nodes = [5, 5], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.2
[[solid]]
shape = "sphere"
radius = 0.1
[[solid]]
shape = "sphere"
radius = 0.2
)";

Scene with(std::vector<std::string> settings) {
  return read_scene_text(two_of_each, "/scenes/two.toml", settings);
}

std::string refusal(std::vector<std::string> settings) {
  try {
    with(std::move(settings));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SceneSettings, OneKeyOfATable) {
  EXPECT_EQ(with({"time.step=2e-3"}).time.step, 2e-3);
  EXPECT_EQ(with({"time.step=2e-3", "time.step=3e-3"}).time.step, 3e-3);
}

TEST(SceneSettings, MakesTablesThatAreNotThere) {
  const Scene scene = with({"solver.name=mpcg", "wind.velocity=[1,2,3]", "title=One two"});
  EXPECT_EQ(scene.solver.name, "mpcg");
  EXPECT_EQ(scene.wind.velocity, Vec3(1, 2, 3));
  EXPECT_EQ(scene.title, "One two");
}

TEST(SceneSettings, AVariantNeedsNoQuotes) {
  EXPECT_EQ(with({"solver.name=mpcg:diagonal"}).solver.name, "mpcg:diagonal");
}

TEST(SceneSettings, WithoutNumberAllEntries) {
  const Scene scene = with({"cloth.k_stretch=6000", "cloth.grid.nodes=[41,42]", "solid.radius=7"});
  for (const Cloth& cloth : scene.cloths) {
    EXPECT_EQ(cloth.material.k_stretch, 6000);
    EXPECT_EQ(cloth.grid.nu, 41);
    EXPECT_EQ(cloth.grid.nv, 42);
  }
  for (const Solid& solid : scene.solids) EXPECT_EQ(solid.radius, 7);
}

TEST(SceneSettings, WithNumberOneEntry) {
  const Scene scene =
      with({"cloth.1.k_stretch=6000", "solid.0.radius=7", "cloth.0.pin.1.release=2"});
  EXPECT_EQ(scene.cloths[0].material.k_stretch, 100);
  EXPECT_EQ(scene.cloths[1].material.k_stretch, 6000);
  EXPECT_EQ(scene.solids[0].radius, 7);
  EXPECT_EQ(scene.solids[1].radius, 0.2);
  EXPECT_LT(scene.cloths[0].pins[0].release, 0);
  EXPECT_EQ(scene.cloths[0].pins[1].release, 2);
}

TEST(SceneSettings, RemovesAList) { EXPECT_TRUE(with({"solid=[]"}).solids.empty()); }

TEST(SceneSettings, MistakesAreReportedAsTheUserTypedThem) {
  const std::pair<const char*, const char*> cases[] = {
      {"time.step", "--set time.step: expected key=value"},
      {"time.step=", "--set time.step=: there is no value"},
      {"time..step=1", "--set time..step=1: a part of the key is empty"},
      {"time.step=5ms",
       "--set time.step=5ms: time.step: expected a number, in s, found the text \"5ms\""},
      {"time.step=5", "--set time.step=5: time.step = 5 s is out of range"},
      {"time.stepp=5", "--set time.stepp=5: unknown key 'stepp' in time; did you mean 'step'?"},
      {"clot.k_bend=5",
       "--set clot.k_bend=5: unknown key 'clot' at the top level; did you mean 'cloth'?"},
      {"cloth.k_bent=5",
       "--set cloth.k_bent=5: unknown key 'k_bent' in cloth.0; did you mean 'k_bend'?"},
      {"cloth.2.k_bend=5", "--set cloth.2.k_bend=5: there is no number 2 in 'cloth', which has 2"},
      {"cloth.0=5", "--set cloth.0=5: name a key of this entry"},
      {"time.step.x=5", "--set time.step.x=5: 'step' holds a value"},
      {"gravity.z=-1", "--set gravity.z=-1: gravity: expected an array of 3 numbers, in m/s²"},
      {"cloth.1.pin.release=2", "--set cloth.1.pin.release=2: the scene has no 'pin'"},
      {"cloth.grid.nodes=[41,41", "--set cloth.grid.nodes=[41,41: the value is not valid TOML"},
      {"solid.0.rotation.axis=[0,0,1]",
       "--set solid.0.rotation.axis=[0,0,1]: solid.0.rotation.degrees is missing"},
      {"solid.size=[1,1,1]", "--set solid.size=[1,1,1]: solid.0.size is only for a box"},
  };
  for (const auto& [setting, expected] : cases)
    EXPECT_TRUE(refusal({setting}).starts_with(expected))
        << refusal({setting}) << "\nexpected " << expected;
}

}  // namespace
}  // namespace taut
