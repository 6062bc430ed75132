// A scene's World: the same sentences for a file and for a program, and places in the file for what
// is found out when the world is made.

#include "taut/scene/scene_world.h"

#include <gtest/gtest.h>

#include <fstream>

#include "io/temporary_folder.h"
#include "taut/base/error.h"
#include "taut/scene/scene_file.h"

namespace taut {
namespace {

Scene sheet() {
  return read_scene_text(R"(
[[cloth]]
grid = { nodes = [3, 4], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.2
pin = [{ corners = ["u0v0"] }]
)",
                         "scene.toml");
}

template <class Call>
std::string refusal(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string of_program(const std::function<void(Scene&)>& change) {
  Scene scene = sheet();
  scene.places.clear();
  change(scene);
  return refusal([&] { make_world(scene); });
}

std::string of_file(const char* setting) {
  const std::string text = R"(
[[cloth]]
grid = { nodes = [3, 4], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.2
pin = [{ corners = ["u0v0"] }]
)";
  const std::string said = refusal(
      [&] { make_world(read_scene_text(text, "scene.toml", std::vector<std::string>{setting})); });
  const std::string place = std::string("--set ") + setting + ": ";
  return said.starts_with(place) ? said.substr(place.size()) : "no place: " + said;
}

TEST(SceneWorld, AProgramGetsTheSentencesOfAFile) {
  EXPECT_EQ(of_program([](Scene&) {}), "");
  EXPECT_EQ(of_program([](Scene& s) { s.cloths[0].density = -1; }), of_file("cloth.density=-1"));
  EXPECT_EQ(of_program([](Scene& s) { s.time.step = -5e-3; }), of_file("time.step=-5e-3"));
  EXPECT_EQ(of_program([](Scene& s) { s.wind.gust = 11; }), of_file("wind.gust=11"));
  EXPECT_EQ(of_program([](Scene& s) { s.solver.name = "core_pgc"; }),
            of_file("solver.name=core_pgc"));
  EXPECT_EQ(of_program([](Scene& s) { s.solver.core = "all"; }), of_file("solver.core=all"));
  EXPECT_EQ(of_program([](Scene& s) { s.cloths[0].grid.nu = 1; }),
            of_file("cloth.grid.nodes=[1,4]"));
  EXPECT_EQ(of_program([](Scene& s) { s.contact.thickness = 2; }), of_file("contact.thickness=2"));
}

TEST(SceneWorld, UnknownCornersAndEdgesAreRefused) {
  const auto says = [](const std::string& text, const char* words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  says(of_program([](Scene& s) { s.cloths[0].pins[0].where.corners = {"u0v2"}; }),
       "cloth.0.pin.0.corners: \"u0v2\" is not known: expected one of \"u0v0\"");
  says(of_program([](Scene& s) { s.cloths[0].pins[0].where = {.edges = {"w0"}}; }),
       "\"w0\" is not known");
  const Scene scene = sheet();
  says(refusal([&] { selected_nodes(scene.cloths[0], {.corners = {"u0v2"}}); }), "is not known");
  says(refusal([&] { selected_nodes(scene.cloths[0], {.edges = {""}}); }), "is not known");
  says(of_program([](Scene& s) { s.cloths.clear(); }), "a scene has at least one");
}

TEST(SceneWorld, WhatIsFoundOutLaterHasItsPlaceInTheFile) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "m.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const std::string text = R"([[cloth]]
mesh = "m.obj"
density = 0.2
[[cloth.pin]]
nodes = [0, 7]
)";
  const std::string said =
      refusal([&] { make_world(read_scene_text(text, folder / "scene.toml")); });
  EXPECT_NE(said.find("scene.toml:5:9: cloth.0.pin.0.nodes: a pin holds node 7, but the nodes of "
                      "cloth 'cloth_0' are 0 to 2"),
            std::string::npos)
      << said;
}

}  // namespace
}  // namespace taut
