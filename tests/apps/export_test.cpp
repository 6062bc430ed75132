// taut export and run --export: file names, choices, what a kill leaves. Whether the numbers are
// right: read_back.py.

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <tuple>

#include "program.h"

namespace taut::test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;
using Files = std::map<std::string, std::string>;  // name -> content

Files files_in(const fs::path& folder) {
  Files files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder))
    files[entry.path().filename().string()] = read_text(entry.path());
  return files;
}

void run_small(const WorkFolder& folder, const Names& more = {}) {
  folder.file("small.toml", small_scene());
  Names arguments{"run", "small.toml", "--out", "r", "--quiet", "--no-picture"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ProgramEnd end = taut(folder, arguments);
  ASSERT_EQ(end.exit_code, 0) << end.err;
}

TEST(Export, WritesClothsAndSolids) {
  const WorkFolder folder;
  run_small(folder, {"--frames", "2"});
  const ProgramEnd end = taut(folder, {"export", "r", "--format", "obj"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_EQ(end.out, "3 frames of 1 cloth and 1 solid written to r/obj\n");
  EXPECT_EQ(end.err, "");
  EXPECT_EQ(names_in(folder / "r/obj"),
            (Names{"sheet_000000.obj", "sheet_000001.obj", "sheet_000002.obj", "solid_0.obj"}));
  const Names obj = lines_of(read_text(folder / "r/obj/sheet_000002.obj"));
  EXPECT_EQ(
      std::ranges::count_if(obj, [](const std::string& line) { return line.starts_with("v "); }),
      72);
  EXPECT_EQ(
      std::ranges::count_if(obj, [](const std::string& line) { return line.starts_with("f "); }),
      2 * 8 * 7);
  ASSERT_EQ(taut(folder, {"export", "r", "--format", "pc2", "--out", "points"}).exit_code, 0);
  EXPECT_EQ(names_in(folder / "points"), (Names{"sheet.obj", "sheet.pc2", "solid_0.obj"}));
  EXPECT_EQ(read_text(folder / "points/sheet.pc2").size(), 32u + 3 * 72 * 12);
}

TEST(Export, WritesTheFileThatIsAskedFor) {
  const WorkFolder folder;
  run_small(folder, {"--frames", "2"});
  const auto exported = [&](const Names& more) {
    Names arguments{"export", "r", "--out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramEnd end = taut(folder, arguments);
    EXPECT_EQ(end.exit_code, 0) << end.err;
    return end.out.substr(end.out.rfind(' ') + 1);
  };
  ASSERT_EQ(taut(folder, {"export", "r", "--format", "usd", "--out", "u"}).exit_code, 0);
  ASSERT_EQ(taut(folder, {"export", "r", "--format", "gltf", "--out", "g"}).exit_code, 0);
  EXPECT_EQ(exported({"name.usda"}), "name.usda\n");
  EXPECT_EQ(exported({"made/Fine name.usd", "--format", "usd"}), "name.usd\n");
  EXPECT_EQ(exported({"made/b.glb"}), "made/b.glb\n");
  EXPECT_EQ(read_text(folder / "name.usda"), read_text(folder / "u/sequence.usda"));
  EXPECT_EQ(read_text(folder / "made/Fine name.usd"), read_text(folder / "u/sequence.usda"));
  EXPECT_EQ(read_text(folder / "made/b.glb"), read_text(folder / "g/sequence.glb"));
  EXPECT_EQ(exported({"o/n.obj"}), "o/n_*.obj\n");
  EXPECT_EQ(names_in(folder / "o"), (Names{"n_sheet_000000.obj", "n_sheet_000001.obj",
                                           "n_sheet_000002.obj", "n_solid_0.obj"}));
  EXPECT_EQ(exported({"p/n.pc2"}), "p/n_*.pc2\n");
  EXPECT_EQ(names_in(folder / "p"), (Names{"n_sheet.obj", "n_sheet.pc2", "n_solid_0.obj"}));
  EXPECT_EQ(exported({"v/a&b.pvd", "--frames", "1"}), "v/a&b.pvd\n");
  EXPECT_EQ(names_in(folder / "v"), (Names{"a&b.pvd", "a&b_sheet_000001.vtp", "a&b_solid_0.vtp"}));
  EXPECT_NE(read_text(folder / "v/a&b.pvd").find("file=\"a&amp;b_sheet_000001.vtp\""),
            std::string::npos);
  fs::create_directory(folder / "folder.obj");
  ASSERT_EQ(taut(folder, {"export", "r", "--format", "ply", "--out", "folder.obj"}).exit_code, 0);
  EXPECT_EQ(names_in(folder / "folder.obj").size(), 4u);
}

TEST(Export, AFileOfAnotherKindIsRefused) {
  const WorkFolder folder;
  run_small(folder, {"--frames", "1"});
  const ProgramEnd sister = taut(folder, {"export", "r", "--out", "a.usdc"});
  EXPECT_EQ(sister.exit_code, 1);
  EXPECT_NE(sister.err.find("a.usdc: files ending in .usdc are not written; USD is written as "
                            "text: .usda"),
            std::string::npos)
      << sister.err;
  const ProgramEnd other = taut(folder, {"export", "r", "--out", "a.obj", "--format", "usd"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("--out a.obj is a file of the format obj, --format says usd"),
            std::string::npos)
      << other.err;
  const ProgramEnd unknown = taut(folder, {"export", "r", "--out", "a.abc"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("in which format? --format usd|obj|"), std::string::npos)
      << unknown.err;
}

// A PC2 file says how many frames are between two samples: chosen frames must not play faster.
TEST(Export, PointCachesOfChosenFramesPlayAtTheirSpeed) {
  const WorkFolder folder;
  run_small(folder);
  for (const auto& [range, first, rate] :
       {std::tuple<const char*, float, float>{"1:5:2", 1.0F, 2.0F}, {"0:6", 0.0F, 1.0F}}) {
    ASSERT_EQ(taut(folder, {"export", "r", "--format", "pc2", "--out", "points", "--frames", range})
                  .exit_code,
              0);
    float header[2] = {};
    std::memcpy(header, read_text(folder / "points/sheet.pc2").data() + 20, sizeof(header));
    EXPECT_EQ(header[0], first) << range;
    EXPECT_EQ(header[1], rate) << range;
  }
}

TEST(Export, FramesAreChosen) {
  const WorkFolder folder;
  run_small(folder);
  const std::vector<std::pair<std::string, Names>> choices{
      {"2:4", {"2", "3", "4"}}, {"1:6:3", {"1", "4"}}, {"5:", {"5", "6"}},
      {":1", {"0", "1"}},       {"::4", {"0", "4"}},   {"3", {"3"}}};
  for (const auto& [range, numbers] : choices) {
    fs::remove_all(folder / "o");
    ASSERT_EQ(
        taut(folder, {"export", "r", "--format", "ply", "--out", "o", "--frames", range}).exit_code,
        0)
        << range;
    Names expected;
    for (const std::string& number : numbers) expected.push_back("sheet_00000" + number + ".ply");
    expected.emplace_back("solid_0.ply");
    EXPECT_EQ(names_in(folder / "o"), expected) << range;
  }
  for (const char* wrong : {"a", "1-2", "1:2:3:4", "4:2", "1:5:0", "-1:3", "99999999999"})
    EXPECT_EQ(taut(folder, {"export", "r", "--format", "ply", "--frames", wrong}).exit_code, 2)
        << wrong;
  const ProgramEnd beyond = taut(folder, {"export", "r", "--format", "ply", "--frames", "4:7"});
  EXPECT_EQ(beyond.exit_code, 1);
  EXPECT_NE(beyond.err.find("has the frames 0 to 6; 4:7 was asked for"), std::string::npos)
      << beyond.err;
}

TEST(Export, RefusesWhatItCannotDo) {
  const WorkFolder folder;
  run_small(folder, {"--frames", "1"});
  for (const Names& more : {Names{"--format", "gif"}, Names{"--format", "obj", "--scale", "0"},
                            Names{"--format", "obj", "--scale", "-1"},
                            Names{"--format", "obj", "--up", "x"}, Names{}}) {
    Names arguments{"export", "r"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(taut(folder, arguments).exit_code, 2);
  }
  EXPECT_EQ(taut(folder, {"export", "r", "--format", "gltf", "--up", "z"}).exit_code, 1);
  const ProgramEnd nothing = taut(folder, {"export", "nothing", "--format", "obj"});
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_NE(nothing.err.find("nothing: holds no scene.toml: it is no result of `taut run`"),
            std::string::npos)
      << nothing.err;
  EXPECT_EQ(names_in(folder / "r"),
            (Names{"checkpoint", "frames", "scene.toml", "stats.csv", "summary.json"}));
}

TEST(Export, OfARunThatHasNotFinishedSaysSo) {
  const WorkFolder folder;
  run_small(folder);
  fs::remove(folder / "r/summary.json");
  fs::remove(folder / "r/frames/000006.npy");
  const ProgramEnd end = taut(folder, {"export", "r", "--format", "usd"});
  EXPECT_EQ(end.exit_code, 0);
  EXPECT_NE(
      end.err.find(
          "has not finished (it is running, or was interrupted); there are frames 0 to 5 so far"),
      std::string::npos)
      << end.err;
  EXPECT_NE(end.out.find("6 frames of"), std::string::npos) << end.out;
}

TEST(Export, WhileARunGoesOnMakesTheSameFilesAsAfterwards) {
  for (const char* format : {"usd", "pc2", "vtk", "gltf"}) {
    const WorkFolder folder;
    run_small(folder, {"--export", format});
    ASSERT_EQ(taut(folder, {"export", "r", "--format", format, "--out", "later"}).exit_code, 0);
    const Files live = files_in(folder / "r" / format), later = files_in(folder / "later");
    EXPECT_FALSE(later.empty());
    EXPECT_EQ(live, later) << format;
  }
}

TEST(Export, ThatCannotWorkIsRefusedBeforeTheRun) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const ProgramEnd big =
      taut(folder, {"run", "small.toml", "--out", "r", "--no-picture", "--export", "gltf", "--set",
                    "time.frames=400", "--set", "time.steps_per_frame=1", "--set", "time.step=1e-3",
                    "--set", "cloth.grid.nodes=[420,420]", "--set", "contact.self=false"});
  EXPECT_EQ(big.exit_code, 1);
  EXPECT_NE(big.err.find("more than the 512 MiB that programs open"), std::string::npos) << big.err;
}

TEST(Export, ThatFailsLetsTheRunGoOn) {
  const WorkFolder folder;
  run_small(folder, {"--frames", "1"});
  folder.file("r/ply", "a file where the folder would be");
  const ProgramEnd end =
      taut(folder, {"run", "small.toml", "--out", "r", "--no-picture", "--export", "ply"});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_NE(end.err.find("the export has ended, the run goes on: r/ply/"), std::string::npos)
      << end.err;
  EXPECT_TRUE(fs::exists(folder / "r/frames/000006.npy"));
  EXPECT_NE(read_text(folder / "r/summary.json").find("\"finished\""), std::string::npos);
}

// Killed at any time, a file is there whole or not at all.
TEST(Export, KilledLeavesEachFileWholeOrAbsent) {
  const WorkFolder folder;
  run_small(folder, {"--set", "cloth.grid.nodes=[60,60]", "--set", "time.frames=12", "--set",
                     "time.steps_per_frame=1"});
  for (const char* format : {"usd", "ply", "pc2", "vtk", "gltf"}) {
    const auto started = std::chrono::steady_clock::now();
    ASSERT_EQ(taut(folder, {"export", "r", "--format", format, "--out", "whole"}).exit_code, 0);
    const auto taken = std::chrono::steady_clock::now() - started;
    const Files whole = files_in(folder / "whole");
    int absent = 0;
    for (int trial = 0; trial <= 8; ++trial) {  // the first is killed at once
      const RunningProgram program(folder, {"export", "r", "--format", format, "--out", "killed"});
      std::this_thread::sleep_for(taken * trial / 9);
      program.send(SIGKILL);
      program.wait();
      const Files left = files_in(folder / "killed");
      for (const auto& [name, content] : whole) {
        const auto found = left.find(name);
        absent += found == left.end();
        if (found == left.end()) continue;
        EXPECT_TRUE(found->second == content) << name << " is half written";
      }
      for (const auto& [name, content] : left)
        EXPECT_TRUE(whole.count(name) || name.find(".tmp") != std::string::npos) << name;
      fs::remove_all(folder / "killed");
    }
    EXPECT_GT(absent, 0) << format << ": no kill came in time";
    fs::remove_all(folder / "whole");
  }
}

TEST(Export, OfAnInterruptedRunHasWhatThereIsAndResumeHasAll) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const RunningProgram run(folder, {"run", "small.toml", "--out", "r", "--quiet", "--no-picture",
                                    "--export", "pc2", "--set", "time.frames=300"});
  ASSERT_TRUE(
      RunningProgram::wait_until([&] { return fs::exists(folder / "r/frames/000005.npy"); }));
  run.send(SIGINT);
  EXPECT_EQ(run.wait().exit_code, 1);
  const auto frames = static_cast<std::size_t>(std::ranges::count_if(
      names_in(folder / "r/frames"), [](const std::string& name) { return name[0] == '0'; }));
  ASSERT_LT(frames, 301u);
  EXPECT_EQ(read_text(folder / "r/pc2/sheet.pc2").size(), 32 + frames * 72 * 12);
  const ProgramEnd resumed =
      taut(folder, {"resume", "r", "--quiet", "--no-picture", "--export", "pc2"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(read_text(folder / "r/pc2/sheet.pc2").size(), 32u + 301 * 72 * 12);
}

TEST(Export, ARunKilledInTheMiddleLeavesNoHalfFile) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const RunningProgram run(
      folder, {"run", "small.toml", "--out", "r", "--quiet", "--no-picture", "--export", "vtk",
               "--set", "cloth.grid.nodes=[60,60]", "--set", "time.frames=400"});
  ASSERT_TRUE(
      RunningProgram::wait_until([&] { return fs::exists(folder / "r/vtk/sheet_000003.vtp"); }));
  run.send(SIGKILL);
  run.wait();
  Files left = files_in(folder / "r/vtk");
  std::erase_if(left,
                [](const auto& file) { return file.first.find(".tmp") != std::string::npos; });
  EXPECT_FALSE(left.count("sequence.pvd"));
  ASSERT_EQ(taut(folder, {"export", "r", "--format", "vtk", "--out", "later"}).exit_code, 0);
  const Files later = files_in(folder / "later");
  EXPECT_GE(left.size(), 4u);
  for (const auto& [name, content] : left) {
    ASSERT_TRUE(later.count(name)) << name;
    EXPECT_TRUE(later.at(name) == content) << name << " is half written";
  }
}

}  // namespace
}  // namespace taut::test
