// What somebody does on the first day with Taut, wrongly or half: nothing of theirs is overwritten,
// nothing lost is passed over in silence.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "program.h"

namespace taut::test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

constexpr const char* square =
    "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nv 0.2 0 0\nv 0.2 0.1 0\nf 1 2 3\nf 1 3 4\nf 2 5 "
    "6\nf 2 6 3\n";

std::string mesh_scene(const std::string& more = "") {
  return "title = \"Mesh\"\n[time]\nframes = 3\n[[cloth]]\nname = \"patch\"\nmesh = "
         "\"patch.obj\"\ndensity = 0.15\n[[cloth.pin]]\nnodes = "
         "[0]\n" +
         more;
}

void expect_said(const ProgramEnd& end, int code, const Names& parts) {
  EXPECT_EQ(end.exit_code, code) << end.err;
  for (const std::string& part : parts)
    EXPECT_NE((end.out + end.err).find(part), std::string::npos) << part << "\n"
                                                                 << end.out << end.err;
}

TEST(FirstDay, CheckDoesNotWriteOverTheSceneOrItsMesh) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  folder.file("patch.obj", square);
  folder.file("mesh.toml", mesh_scene());
  expect_said(taut(folder, {"check", "small.toml", "--out", "small.toml"}), 2,
              {"small.toml", ".obj"});
  expect_said(taut(folder, {"check", "small.toml", "--out", "start.txt"}), 2,
              {"start.txt", ".obj"});
  expect_said(taut(folder, {"check", "mesh.toml", "--out", "patch.obj"}), 1,
              {"patch.obj", "cloth 'patch'", "--out"});
  EXPECT_EQ(read_text(folder / "small.toml"), small_scene());
  EXPECT_EQ(read_text(folder / "patch.obj"), square);
  expect_said(taut(folder, {"check", "mesh.toml", "--out", "start.obj"}), 0, {"start.obj"});
}

TEST(FirstDay, ResumeRefusesAChangedMesh) {
  const WorkFolder folder;
  folder.file("patch.obj", square);
  folder.file("ball.obj", "v 0 0 -1\nv 1 0 -1\nv 0 1 -1\nf 1 2 3\n");
  folder.file("mesh.toml", mesh_scene("[[solid]]\nshape = \"mesh\"\nmesh = \"ball.obj\"\n"));
  ASSERT_EQ(taut(folder, {"run", "mesh.toml", "--out", "r", "--quiet", "--no-picture"}).exit_code,
            0);
  const std::string last = read_text(folder / "r/frames/000003.npy");
  // As many vertices and triangles as before, so that only what they are tells.
  std::string wider = square;
  wider.replace(wider.find("0.2 0.1"), 7, "0.2 0.2");
  for (const auto& [file, content] : {std::pair<std::string, std::string>{"patch.obj", wider},
                                      {"ball.obj", "v 0 0 -1\nv 1 0 -1\nv 0 2 -1\nf 1 2 3\n"}}) {
    const std::string before = read_text(folder / file);
    folder.file(file, content);
    expect_said(taut(folder, {"resume", "r", "--frames", "6", "--no-picture"}), 1,
                {file, "has changed", "taut run"});
    EXPECT_FALSE(fs::exists(folder / "r/frames/000004.npy"));
    EXPECT_EQ(read_text(folder / "r/frames/000003.npy"), last);
    folder.file(file, before);
  }
  expect_said(taut(folder, {"resume", "r", "--frames", "6", "--no-picture"}), 0,
              {"going on after frame 3"});
}

TEST(FirstDay, AFinishedRunIsExtendedToTheSameBitsAndOtherwiseLeftAlone) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const Names quiet{"--quiet", "--no-picture"};
  ASSERT_EQ(
      taut(folder, {"run", "small.toml", "--out", "whole", "--quiet", "--no-picture"}).exit_code,
      0);
  ASSERT_EQ(
      taut(folder, {"run", "small.toml", "--out", "r", "--frames", "3", "--quiet", "--no-picture"})
          .exit_code,
      0);
  const std::string summary = read_text(folder / "r/summary.json");
  expect_said(taut(folder, {"resume", "r"}), 0, {"has all its 3 frames", "--frames N"});
  EXPECT_EQ(read_text(folder / "r/summary.json"), summary);
  expect_said(taut(folder, {"resume", "r", "--frames", "2"}), 1, {"has 3 frames already"});
  EXPECT_EQ(read_text(folder / "r/summary.json"), summary);
  expect_said(taut(folder, {"resume", "r", "--frames", "6", "--quiet", "--no-picture"}), 0, {});
  for (const char* name : {"frames/000006.npy", "checkpoint/state.bin", "scene.toml"})
    EXPECT_TRUE(read_text(folder / "r" / name) == read_text(folder / "whole" / name)) << name;
  EXPECT_EQ(nlohmann::json::parse(read_text(folder / "r/summary.json")).at("frames"), 7);
}

TEST(FirstDay, ResumeClearsWhatAKillLeft) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(
      taut(folder, {"run", "small.toml", "--out", "r", "--frames", "2", "--quiet", "--no-picture"})
          .exit_code,
      0);
  for (const char* left :
       {"r/checkpoint/state.bin.tmp4711", "r/frames/000003.npy.tmp4711", "r/summary.json.tmp4711"})
    folder.file(left, "half");
  folder.file("r/mine.tmp4711", "not Taut's");
  ASSERT_EQ(taut(folder, {"resume", "r", "--frames", "4", "--quiet", "--no-picture"}).exit_code, 0);
  EXPECT_EQ(names_in(folder / "r/checkpoint"), Names{"state.bin"});
  EXPECT_FALSE(fs::exists(folder / "r/frames/000003.npy.tmp4711") ||
               fs::exists(folder / "r/summary.json.tmp4711"));
  EXPECT_TRUE(fs::exists(folder / "r/mine.tmp4711"));
}

TEST(FirstDay, ARunThatExplodesSaysSo) {
  const WorkFolder folder;
  folder.file("small.toml", std::string(small_scene()));
  const Names thrown{
      "run",
      "small.toml",
      "--out",
      "r",
      "--frames",
      "2",
      "--no-picture",
      "--quiet",
      "--set",
      "cloth.0.pin.0.key_frames=[{ time = 0 }, { time = 0.005, translation = [0, 0, 100] }]"};
  const ProgramEnd end = taut(folder, thrown);
  expect_said(end, 0,
              {"warning", "not to be trusted", "step 1", "nodes 0 and", "cloth 'sheet'",
               "time.max_halvings"});
  EXPECT_EQ(end.out, "");
  const auto summary = nlohmann::json::parse(read_text(folder / "r/summary.json"));
  ASSERT_EQ(summary.at("warnings").size(), 1u);
  EXPECT_GE(summary.at("this_run").at("steps_overshot"), 1);
  EXPECT_GT(std::stod(fields_of(lines_of(read_text(folder / "r/stats.csv"))[1]).back()), 0.05);

  // Newton's method foresees nothing, and without halving nothing is retried: what they stretch is
  // said all the same. Where and when the sheet is torn most hangs on the last digits in Newton's
  // wild motion.
  const auto with = [&](const char* setting) {
    Names other = thrown;
    other.insert(other.end(), {"--set", setting});
    return taut(folder, other);
  };
  expect_said(with("time.max_halvings=0"), 0,
              {"warning", "more than twice their length", "in step 1", "nodes 0 and"});
  expect_said(
      with("time.integrator=newton"), 0,
      {"warning", "more than twice their length", "in step ", "between nodes ", "cloth 'sheet'"});

  ASSERT_EQ(taut(folder, {"run", "small.toml", "--out", "calm", "--no-picture", "--quiet"}).err,
            "");
  EXPECT_TRUE(
      nlohmann::json::parse(read_text(folder / "calm/summary.json")).at("warnings").empty());
}

TEST(FirstDay, RenderLeavesFoldersOfOthersAlone) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"run", "small.toml", "--out", "r", "--quiet", "--no-picture"}).exit_code,
            0);
  fs::create_directories(folder / "mine");
  folder.file("mine/000000.png", "a photograph");
  folder.file("mine/thesis.txt", "years of work");
  const Names render{"render", "r", "--size", "32x24", "--samples", "1", "--fps", "100", "--out"};
  const auto into = [&](const std::string& out, const Names& more = {}) {
    Names arguments = render;
    arguments.push_back(out);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return taut(folder, arguments);
  };
  expect_said(into("mine"), 1, {"mine", "thesis.txt"});
  EXPECT_EQ(read_text(folder / "mine/000000.png"), "a photograph");
  ASSERT_EQ(into("film").exit_code, 0);
  const std::size_t whole = names_in(folder / "film").size();
  ASSERT_EQ(into("film", {"--frames", "0:2"}).exit_code, 0);
  EXPECT_LT(names_in(folder / "film").size(), whole)
      << "pictures of the longer film are still there";
}

TEST(FirstDay, ReplacedResultsAndTheirExportsAreSaid) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  folder.file("patch.obj", square);
  folder.file("mesh.toml", mesh_scene());
  ASSERT_EQ(taut(folder, {"run", "small.toml", "--out", "full", "--quiet", "--no-picture",
                          "--export", "obj"})
                .exit_code,
            0);
  const ProgramEnd again = taut(folder, {"run", "small.toml", "--out", "full", "--no-picture"});
  EXPECT_EQ(again.err.find("replaced"), std::string::npos)
      << "the same scene once more is no news: " << again.err;
  expect_said(taut(folder, {"run", "mesh.toml", "--out", "full", "--no-picture"}), 0,
              {"full held", "\"Small\"", "7 frames", "full/obj"});

  ASSERT_EQ(taut(folder, {"run", "small.toml", "--out", "r", "--quiet", "--no-picture"}).exit_code,
            0);
  ASSERT_EQ(taut(folder, {"export", "r", "--format", "obj"}).err, "");
  expect_said(taut(folder, {"export", "r", "--format", "obj", "--frames", "0:3"}), 0,
              {"3 files of other frames", "r/obj"});
}

TEST(FirstDay, LostOutputIsAFailure) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  folder.file("A.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 2\n2 2 3\n");
  const std::string query =
      "0,1,0,1,1,1\n0,1,0,1,0,1\n1,1,0,1,0,1\n0,1,1,1,0,1\n0,1,0,1,-1,1\n0,1,0,1,0,1\n1,1,0,1,0,"
      "1\n0,1,1,1,0,1\n";
  folder.file("q.csv", query);
  for (const std::string command :
       {"solve --matrix A.mtx --solver mpcg --json", "ccd q.csv --type vf",
        "run small.toml --frames 1 --no-picture --json-lines", "check small.toml", "--help"}) {
    const std::string line =
        "cd '" + folder.path().string() + "' && " + TAUT_PROGRAM + " " + command;
    EXPECT_EQ(WEXITSTATUS(std::system((line + " > ok 2> errors").c_str())), 0)
        << command << read_text(folder / "errors");
    EXPECT_EQ(WEXITSTATUS(std::system((line + " > /dev/full 2> errors").c_str())), 1) << command;
    EXPECT_NE(read_text(folder / "errors").find("standard output could not be written"),
              std::string::npos)
        << read_text(folder / "errors");
  }
}

TEST(FirstDay, FoldersThatCannotBeWrittenAreNamed) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const ProgramEnd file = taut(folder, {"run", "small.toml", "--out", "small.toml/x", "--quiet"});
  expect_said(file, 1, {"small.toml/x", "is a file"});
  EXPECT_EQ(file.err.find("please report"), std::string::npos) << file.err;
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  ASSERT_EQ(taut(folder, {"run", "small.toml", "--out", "r", "--quiet", "--no-picture"}).exit_code,
            0);
  ::chmod((folder / "r").c_str(), 0555);
  for (const Names& arguments :
       {Names{"run", "small.toml", "--out", "r"}, Names{"resume", "r", "--frames", "9"}}) {
    const ProgramEnd end = taut(folder, arguments);
    expect_said(end, 1, {"r", "ermission denied", "check the folder's permissions"});
    EXPECT_EQ(end.err.find("please report"), std::string::npos) << end.err;
  }
  ::chmod((folder / "r").c_str(), 0755);
}

TEST(FirstDay, WhatOnlyTheMeshShowsIsReportedAtItsLine) {
  const WorkFolder folder;
  folder.file("patch.obj", square);
  std::string scene = mesh_scene();
  folder.file("mesh.toml", scene.replace(scene.find("[0]"), 3, "[0, 2799]"));
  expect_said(taut(folder, {"check", "mesh.toml"}), 1,
              {"mesh.toml:9:9: cloth.0.pin.0.nodes: a pin holds node 2799, but the nodes of cloth "
               "'patch' are 0 to 5"});
  expect_said(taut(folder, {"check", "mesh.toml", "--set", "cloth.0.pin.0.nodes=[7]"}), 1,
              {"--set cloth.0.pin.0.nodes=[7]: cloth.0.pin.0.nodes: a pin holds node 7"});
}

TEST(FirstDay, UnitsAndSeamsOfAMeshAreDoubted) {
  const WorkFolder folder;
  folder.file("patch.obj", std::string(square) + "stitch 1 2\nstitch 3 4\n");
  folder.file(
      "mesh.toml",
      mesh_scene("[[solid]]\nshape = \"sphere\"\nradius = 0.2\ntranslation = [0, 0, -1]\n"));
  expect_said(taut(folder, {"check", "mesh.toml"}), 0,
              {"patch.obj:11:", "stitch", "has no effect", "show through"});
  const ProgramEnd large = taut(folder, {"check", "mesh.toml", "--set", "cloth.scale=350"});
  expect_said(large, 0, {"70 m long", "centimetres", "scale = 3.5"});
  EXPECT_EQ(large.out.find("show through"), std::string::npos) << large.out;
}

TEST(FirstDay, ArgumentsThatCannotBeAreRefusedInPlainNumbers) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  folder.file("A.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 2\n2 2 3\n");
  for (const auto& [arguments, said] :
       {std::pair<Names, const char*>{{"run", "small.toml", "--frames", "-1"},
                                      "--frames: -1 is not allowed: a number from 1 to 1000000"},
        {{"run", "small.toml", "--frames", "0"}, "--frames: 0 is not allowed"},
        {{"run", "small.toml", "--solver", "cor_pcg"}, "did you mean 'core_pcg'?"},
        {{"export", "r", "--format", "obj", "--scale", "0"},
         "--scale: 0 is not allowed: a number above 0"},
        {{"solve", "--matrix", "A.mtx", "--tolerance", "0"}, "from 1e-16 to 1 "}}) {
    const ProgramEnd end = taut(folder, arguments);
    expect_said(end, 2, {said});
    EXPECT_LT(end.err.size(), 1200u);
  }
}

TEST(FirstDay, WhatIsLeftOutIsSaid) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"run", "small.toml", "--out", "r", "--quiet", "--no-picture"}).exit_code,
            0);
  expect_said(taut(folder, {"render", "r", "--out", "x.mp4", "--frame", "4"}), 2,
              {"--frame", "--out FILE.png"});
  EXPECT_FALSE(fs::exists(folder / "x.mp4"));
  fs::remove(folder / "r/frames/000003.npy");
  const ProgramEnd sheet =
      taut(folder, {"render", "r", "--out", "sheet.png", "--size", "32x24", "--samples", "1"});
  expect_said(sheet, 0, {"r/frames/000003.npy is missing", "only 0 to 2"});
  ASSERT_EQ(taut(folder, {"dump", "small.toml", "--step", "1", "--out", "d", "--quiet"}).exit_code,
            0);
  folder.file("d/meta.json", "garbage");
  expect_said(taut(folder, {"solve", "d"}), 1, {"d/meta.json", "dump the system anew"});
}

TEST(FirstDay, NothingIsAdvisedForAPinInsideASolidThatDoesNotHelp) {
  const WorkFolder folder;
  folder.file("inside.toml", std::string(small_scene()));
  const Names inside{"--set", "cloth.0.grid.origin=[-0.3, -0.3, 0.1]", "--set",
                     "cloth.0.pin=[{ nodes = [40] }]"};
  Names check{"check", "inside.toml"}, untangle{"check", "inside.toml", "--untangle"};
  check.insert(check.end(), inside.begin(), inside.end());
  untangle.insert(untangle.end(), inside.begin(), inside.end());
  expect_said(taut(folder, check), 0,
              {"node 40 of cloth 'sheet', held by a pin", "--untangle moves neither"});
  const ProgramEnd refused = taut(folder, untangle);
  expect_said(refused, 1,
              {"node 40 of cloth 'sheet'", "solid 'solid_0'", "Move the pin or the solid"});
  EXPECT_EQ(refused.err.find("allow_intersections"), std::string::npos) << refused.err;
}

TEST(FirstDay, AStepThatFailsComesWithAdvice) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const ProgramEnd end =
      taut(folder, {"run", "small.toml", "--out", "r", "--quiet", "--no-picture", "--set",
                    "time.integrator=newton", "--set", "time.newton_max_iterations=1", "--set",
                    "time.newton_tolerance=1e-12", "--set", "time.max_halvings=0"});
  expect_said(
      end, 1,
      {"Newton's method stopped after 1", "time.newton_max_iterations", "time.step smaller"});
}

TEST(FirstDay, AMistypedVerbIsRecognised) {
  const WorkFolder folder;
  expect_said(taut(folder, {"rnu", "b.toml"}), 2, {"'rnu' is no verb", "did you mean 'run'?"});
  expect_said(taut(folder, {"fly"}), 2, {"'fly' is no verb", "resume"});
  EXPECT_EQ(taut(folder, {"--help"}).out.find("./taut test"), std::string::npos);
  ::setenv("TAUT_LAUNCHER", "1", 1);
  expect_said(taut(folder, {"--help"}), 0, {"./taut test", "./taut setup pardiso"});
  ::unsetenv("TAUT_LAUNCHER");
}

}  // namespace
}  // namespace taut::test
