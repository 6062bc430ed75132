// Every kind of mistake in a scene file: where it is reported, and with which words.

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "taut/base/error.h"
#include "taut/scene/scene_file.h"

namespace taut {
namespace {

struct Broken {
  const char* name;
  std::string text;
  const char* place;                   // "LINE:COLUMN" of the message
  std::vector<const char*> fragments;  // of the same line of the message
};

void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.text; }

// Lines 1 to 3 of most cases.
const std::string sheet =
    "[[cloth]]\ngrid = { nodes = [3, 4], u = [1, 0, 0], v = [0, 1, 0] }\ndensity = 0.2\n";
const std::string ball = sheet + "[[solid]]\nshape = \"sphere\"\nradius = 0.1\n";  // lines 4 to 6

std::vector<Broken> broken_scenes() {
  return {
      // TOML itself.
      {"unit_on_number",
       "[time]\nstep = 5ms\n",
       "2:9",
       {"not valid TOML", "without a unit", "5e-3"}},
      {"missing_quote", "title = \"abc\n", "1:13", {"not valid TOML"}},
      {"bare_text", sheet + "bend_model = linear\n", "4:14", {"not valid TOML", "quotes"}},
      {"open_header", "[time\nstep = 1\n", "1:6", {"not valid TOML", "']'"}},
      {"key_twice",
       "title = \"a\"\ntitle = \"b\"\n",
       "2:9",
       {"not valid TOML", "title", "second time"}},
      {"table_twice", "[time]\n[wind]\n[time]\n", "3:1", {"not valid TOML", "one [header]"}},
      {"single_brackets", "[[cloth]]\n[cloth]\n", "2:1", {"not valid TOML", "[[double brackets]]"}},
      // Keys.
      {"slip_of_the_finger",
       sheet + "  k_strech = 60\n",
       "4:3",
       {"unknown key 'k_strech' in cloth.0", "did you mean 'k_stretch'?"}},
      {"unknown_table",
       "[tim]\nstep = 1\n" + sheet,
       "1:2",
       {"unknown key 'tim' at the top level", "did you mean 'time'?"}},
      {"strange_key",
       sheet + "colour = 3\n",
       "4:1",
       {"unknown key 'colour'", "the keys here are", "k_shear"}},
      {"key_of_another_table",
       sheet + "tolerance = 1e-3\n",
       "4:1",
       {"unknown key 'tolerance'", "it belongs in [solver]"}},
      {"top_key_below_a_table",
       "[time]\nstep = 1e-3\ngravity = [0, 0, -1]\n" + sheet,
       "3:1",
       {"unknown key 'gravity' in time", "top of the file, before the first [table]"}},
      {"unknown_in_inline_table",
       "[[cloth]]\ngrid = { nodes = [3, 4], width = 3, u = [1, 0, 0], v = [0, 1, 0] }\ndensity = "
       "0.2\n",
       "2:26",
       {"unknown key 'width' in cloth.0.grid"}},
      {"unknown_in_pin",
       sheet + "[[cloth.pin]]\nedges = [\"u0\"]\ntime = 3\n",
       "6:1",
       {"unknown key 'time' in cloth.0.pin.0", "write [time]"}},
      {"key_of_another_shape",
       ball + "mesh = \"x.obj\"\n",
       "7:1",
       {"solid.0.mesh is only for a mesh"}},
      {"pin_of_nothing",
       sheet + "[[cloth.pin]]\nnodes = []\n",
       "5:9",
       {"cloth.0.pin.0.nodes: empty", "remove the pin"}},
      {"cloth_out_of_this_world",
       "[[cloth]]\ngrid = { nodes = [3, 4], origin = [1e300, 0, 0], u = [1, 0, 0], v = [0, 1, 0] "
       "}\ndensity = 0.2\n",
       "2:36",
       {"cloth.0.grid.origin = 1e+300 m is out of range", "-1e+06 to 1e+06 m"}},
      // Types.
      {"text_for_number",
       sheet + "[time]\nstep = \"5ms\"\n",
       "5:8",
       {"time.step: expected a number, in s", "the text \"5ms\"", "without quotes"}},
      {"too_many_steps",
       sheet + "[time]\nframes = 50000\nsteps_per_frame = 50000\n",
       "6:19",
       {"50000 frames of 50000 steps are more than 2e9 steps"}},
      {"fraction_for_integer",
       sheet + "[time]\nframes = 2.5\n",
       "5:10",
       {"time.frames: expected an integer", "the number 2.5"}},
      {"number_for_text",
       "title = 5\n" + sheet,
       "1:9",
       {"title: expected a text in quotes", "the integer 5"}},
      {"number_for_flag",
       sheet + "[solver]\nreuse_analysis = 1\n",
       "5:18",
       {"expected true or false", "the integer 1"}},
      {"two_of_three",
       "gravity = [0, -9.81]\n" + sheet,
       "1:11",
       {"gravity: expected an array of 3 numbers", "an array of 2"}},
      {"text_in_vector",
       "gravity = [0, 0, \"g\"]\n" + sheet,
       "1:18",
       {"gravity: expected a number, in m/s²", "the text \"g\""}},
      {"number_for_vector",
       sheet + "velocity = 3\n",
       "4:12",
       {"cloth.0.velocity: expected an array of 3 numbers, in m/s", "the integer 3"}},
      {"value_for_table",
       "time = 3\n" + sheet,
       "1:8",
       {"expected a table [time]", "the integer 3"}},
      {"list_for_table",
       sheet + "[[time]]\nstep = 1e-3\n",
       "4:1",
       {"expected one table: write [time]"}},
      {"table_for_list",
       "[cloth]\ndensity = 1\n",
       "1:1",
       {"write [[cloth]], with double brackets", "found a table"}},
      {"three_grid_counts",
       "[[cloth]]\ngrid = { nodes = [3, 4, 5], u = [1, 0, 0], v = [0, 1, 0] }\ndensity = 0.2\n",
       "2:18",
       {"expected an array of 2 integers", "an array of 3"}},
      {"date_for_number", sheet + "k_bend = 2020-01-01\n", "4:10", {"expected a number", "a date"}},
      // Ranges.
      {"step_in_milliseconds",
       sheet + "[time]\nstep = 5\n",
       "5:8",
       {"time.step = 5 s is out of range", "to 0.1 s", "5 ms is 5e-3"}},
      {"no_frames", sheet + "[time]\nframes = 0\n", "5:10", {"time.frames = 0 is out of range"}},
      {"beyond_32_bits", sheet + "[time]\nframes = 5000000000\n", "5:10", {"out of range"}},
      {"negative_stiffness",
       sheet + "k_stretch = -1\n",
       "4:13",
       {"cloth.0.k_stretch = -1 N/m is out of range", "from 0"}},
      {"zero_radius",
       sheet + "[[solid]]\nshape = \"sphere\"\nradius = 0\n",
       "6:10",
       {"solid.0.radius = 0 m is out of range", "above 0"}},
      {"zero_density",
       "[[cloth]]\ngrid = { nodes = [3, 4], u = [1, 0, 0], v = [0, 1, 0] }\ndensity = 0\n",
       "3:11",
       {"above 0"}},
      {"not_a_number",
       sheet + "k_shear = nan\n",
       "4:11",
       {"cloth.0.k_shear = nan is not a finite number"}},
      {"infinite",
       "gravity = [0, 0, -inf]\n" + sheet,
       "1:18",
       {"gravity = -inf is not a finite number"}},
      {"one_node_wide",
       "[[cloth]]\ngrid = { nodes = [1, 4], u = [1, 0, 0], v = [0, 1, 0] }\ndensity = 1\n",
       "2:19",
       {"= 1 is out of range"}},
      {"too_many_nodes",
       "[[cloth]]\ngrid = { nodes = [20000, 20000], u = [1, 0, 0], v = [0, 1, 0] }\ndensity = 1\n",
       "2:18",
       {"100 million"}},
      // What belongs together.
      {"no_cloth", "title = \"x\"\n", "1:1", {"cloth is missing"}},
      {"empty_list_of_cloths", "cloth = []\n", "1:9", {"cloth is missing", "at least one"}},
      {"no_grid_nodes",
       "[[cloth]]\ngrid = { u = [1, 0, 0], v = [0, 1, 0] }\ndensity = 0.2\n",
       "2:8",
       {"cloth.0.grid.nodes is missing"}},
      {"neither_grid_nor_mesh",
       "[[cloth]]\ndensity = 1\n",
       "1:1",
       {"cloth.0 needs exactly one of grid, tube, mesh, it has none"}},
      {"no_mass",
       "[[cloth]]\ngrid = { nodes = [3, 4], u = [1, 0, 0], v = [0, 1, 0] }\n",
       "1:1",
       {"exactly one of node_mass, density, it has none"}},
      {"two_masses",
       sheet + "node_mass = 1e-5\n",
       "3:1",
       {"exactly one of node_mass, density, it has node_mass and density"}},
      {"flat_grid",
       "[[cloth]]\ngrid = { nodes = [3, 4], u = [1, 0, 0], v = [-2, 0, 0] }\ndensity = 0.2\n",
       "2:45",
       {"not parallel"}},
      {"no_shape", sheet + "[[solid]]\nradius = 1\n", "4:1", {"solid.0.shape is missing"}},
      {"no_radius",
       sheet + "[[solid]]\nshape = \"sphere\"\n",
       "4:1",
       {"solid.0.radius is missing"}},
      {"radius_of_a_box",
       sheet + "[[solid]]\nshape = \"box\"\nsize = [1, 1, 1]\nradius = 0.1\n",
       "7:1",
       {"solid.0.radius is only for a sphere or a cylinder: remove it"}},
      {"velocity_and_path",
       ball + "velocity = [1, 0, 0]\nkey_frames = [{ time = 0 }]\n",
       "7:1",
       {"only for a solid without key_frames"}},
      {"scale_of_a_grid", sheet + "scale = 0.01\n", "4:1", {"scale is only for a cloth with mesh"}},
      {"cap_without_choi_ko",
       sheet + "bend_cap = 5\n",
       "4:1",
       {"bend_cap is only for bend_model choi_ko"}},
      {"name_with_folder",
       sheet + "name = \"front/left\"\n",
       "4:8",
       {"'front/left' becomes part of file names"}},
      {"same_name",
       sheet + "name = \"a\"\n" + sheet + "name = \"a\"\n",
       "1:1",
       {"two entries are named 'a'"}},
      {"pin_without_cloth",
       sheet + "[[pin]]\nedges = [\"u0\"]\n",
       "4:3",
       {"unknown key 'pin' at the top level", "write [[cloth.pin]]"}},
      // Names.
      {"shape_misspelt_with_its_key",
       sheet + "[[solid]]\nshape = \"bax\"\nsize = [1, 1, 1]\n",
       "5:9",
       {"did you mean 'box'?"}},
      {"shape_misspelt",
       sheet + "[[solid]]\nshape = \"spere\"\n",
       "5:9",
       {"\"spere\" is not known", "\"cylinder\"", "did you mean 'sphere'?"}},
      {"integrator_misspelt",
       sheet + "[time]\nintegrator = \"bdf\"\n",
       "5:14",
       {"did you mean 'bdf2'?"}},
      {"solver_misspelt",
       sheet + "[solver]\nname = \"core_pgc\"\n",
       "5:8",
       {"solver.name: \"core_pgc\" is not known", "did you mean 'core_pcg'?"}},
      {"corner_misspelt",
       sheet + "[[cloth.pin]]\ncorners = [\"u0v0\", \"u2v0\"]\n",
       "5:20",
       {"\"u2v0\" is not known", "\"u1v1\""}},
      {"corner_twice",
       sheet + "[[cloth.pin]]\ncorners = [\"u0v0\", \"u0v0\"]\n",
       "5:20",
       {"stands here twice"}},
      // Pins, paths, files.
      {"empty_pin",
       sheet + "[[cloth.pin]]\nrelease = 1\n",
       "4:1",
       {"cloth.0.pin.0 needs exactly one of nodes, corners, edges"}},
      {"node_off_the_grid",
       sheet + "[[cloth.pin]]\nnodes = [0, 12]\n",
       "5:9",
       {"node 12 is not on the grid", "3 x 4", "0 to 11"}},
      {"negative_node",
       sheet + "[[cloth.pin]]\nnodes = [-1]\n",
       "5:10",
       {"cloth.0.pin.0.nodes = -1 is out of range"}},
      {"times_descend",
       ball + "key_frames = [{ time = 1 }, { time = 1 }]\n",
       "7:14",
       {"times must ascend", "number 1"}},
      {"zero_axis",
       ball + "rotation = { axis = [0, 0, 0], degrees = 3 }\n",
       "7:21",
       {"solid.0.rotation.axis", "the axis is zero"}},
      {"no_angle",
       ball + "rotation = { axis = [0, 0, 1] }\n",
       "7:12",
       {"solid.0.rotation.degrees is missing"}},
      {"rotation_as_list",
       ball + "rotation = [0, 0, 90]\n",
       "7:12",
       {"degrees = angle", "an array of 3"}},
      {"quaternion_too_long",
       ball + "rotation = { quaternion = [1, 1, 0, 0] }\n",
       "7:27",
       {"length 1.414", "1 expected"}},
      {"no_such_mesh",
       "[[cloth]]\nmesh = \"nowhere.obj\"\ndensity = 0.2\n",
       "2:8",
       {"there is no file '/scenes/nowhere.obj'", "scene file's folder"}},
      {"mesh_is_a_folder",
       "[[cloth]]\nmesh = \"/\"\ndensity = 0.2\n",
       "2:8",
       {"'/' is not a file"}},
      {"empty_mesh_name",
       "[[cloth]]\nmesh = \"\"\ndensity = 0.2\n",
       "2:8",
       {"a file name was expected"}},
  };
}

std::string message_of(const std::string& text) {
  try {
    read_scene_text(text, "/scenes/broken.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// The lines of `message` that start with `place`.
std::string lines_at(const std::string& message, const std::string& place) {
  std::string found;
  std::istringstream lines(message);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(place)) found += line + "\n";
  return found;
}

class BrokenScene : public testing::TestWithParam<Broken> {};

TEST_P(BrokenScene, IsReportedWithItsPlace) {
  const Broken& broken = GetParam();
  const std::string message = message_of(broken.text);
  const std::string lines =
      lines_at(message, "/scenes/broken.toml:" + std::string(broken.place) + ": ");
  ASSERT_NE(lines, "") << "nothing reported at " << broken.place << "; whole message:\n" << message;
  for (const char* fragment : broken.fragments)
    EXPECT_NE(lines.find(fragment), std::string::npos) << fragment << "\nnot in:\n" << message;
}

// One mistake, one line: no follow-up complaints that would bury it.
TEST_P(BrokenScene, IsReportedOnce) {
  const std::string message = message_of(GetParam().text);
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0) << message;
}

INSTANTIATE_TEST_SUITE_P(Table, BrokenScene, testing::ValuesIn(broken_scenes()),
                         [](const auto& tested) { return tested.param.name; });

TEST(BrokenScenes, TheIntactBaseOfTheTableIsRead) {
  EXPECT_EQ(message_of(sheet), "");
  EXPECT_EQ(message_of(ball), "");
}

TEST(BrokenScenes, SeveralMistakesComeInTheOrderOfTheFile) {
  const std::string message = message_of("[time]\nframes = 0\nstep = 9\n" + sheet + "k_bent = 3\n");
  const std::size_t frames = message.find(":2:10: time.frames"),
                    step = message.find(":3:8: time.step"), key = message.find(":7:1: unknown key");
  ASSERT_NE(key, std::string::npos) << message;
  EXPECT_LT(frames, step);
  EXPECT_LT(step, key);
}

TEST(BrokenScenes, AtMostTwentyLinesAndTheirCount) {
  std::string text = sheet;
  for (int i = 0; i < 30; ++i) text += "zzzzzzzz" + std::to_string(i) + " = 1\n";
  const std::string message = message_of(text);
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 20);
  EXPECT_TRUE(message.ends_with("and 10 more")) << message;
}

}  // namespace
}  // namespace taut
