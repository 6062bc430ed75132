// taut run, resume, check: exact file names and columns, exit codes, where messages go,
// interruption.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program.h"

namespace taut::test {
namespace {

using Names = std::vector<std::string>;

TEST(Run, WritesTheFilesAndColumnsThatAreDocumented) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const ProgramEnd end = taut(folder, {"run", "small.toml"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const auto out = folder / "out/small";
  EXPECT_EQ(names_in(out), (Names{"checkpoint", "contact_sheet.png", "frames", "scene.toml",
                                  "stats.csv", "summary.json"}));
  EXPECT_EQ(names_in(out / "checkpoint"), Names{"state.bin"});
  const Names frames = names_in(out / "frames");
  for (int f = 0; f <= 6; ++f)
    EXPECT_TRUE(std::ranges::find(frames, "00000" + std::to_string(f) + ".npy") != frames.end())
        << f;
  // header of .npy, then 72 nodes of three floats
  EXPECT_EQ(read_text(out / "frames/000003.npy").size(), 128u + 72 * 3 * 4);
  EXPECT_EQ(read_text(out / "contact_sheet.png").substr(1, 3), "PNG");

  const Names stats = lines_of(read_text(out / "stats.csv"));
  ASSERT_EQ(stats.size(), 19u);
  const std::string columns =
      "step,time,frame,nodes,dof,constraints,contacts,solver,core_springs,iterations,relative_"
      "residual,assemble_ms,order_ms,factor_ms,"
      "solve_ms,contact_ms,"
      "step_ms,kinetic_J,elastic_J,max_stretch,intersections,bound_iterations,precision,fallbacks,"
      "collapsed_springs,retries,zone_nodes";
  EXPECT_EQ(stats[0].substr(0, columns.size()), columns);
  for (const std::string& row : stats) EXPECT_EQ(fields_of(row).size(), fields_of(stats[0]).size());
  const Names last = fields_of(stats[18]);
  EXPECT_EQ(last[0], "18");
  EXPECT_NEAR(std::stod(last[1]), 18 * 5e-3, 1e-12);
  EXPECT_EQ(last[2], "6");
  EXPECT_EQ(last[3], "72");
  EXPECT_EQ(std::stoi(last[4]) + std::stoi(last[5]), 3 * 72);
  EXPECT_EQ(last[7], "core_fast");  // what `auto`, the default, chooses

  const auto summary = nlohmann::json::parse(read_text(out / "summary.json"));
  EXPECT_EQ(summary.at("status"), "finished");
  EXPECT_EQ(summary.at("steps_total"), 18);
  EXPECT_TRUE(summary.contains("instruction_set"));
  EXPECT_NE(end.out.find("contact_sheet.png"), std::string::npos);
}

TEST(Run, DoesWhatItsOptionsSay) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const ProgramEnd end = taut(
      folder, {"run", "small.toml", "--no-picture", "--out", "here", "--frames", "2", "--solver",
               "mpcg", "--set", "cloth.k_stretch=50", "--threads", "1", "--quiet", "--no-picture"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_EQ(end.out + end.err, "");
  const Names stats = lines_of(read_text(folder / "here/stats.csv"));
  ASSERT_EQ(stats.size(), 7u);
  EXPECT_EQ(fields_of(stats[1])[7], "mpcg");
  EXPECT_NE(read_text(folder / "here/scene.toml").find("k_stretch = 50"), std::string::npos);

  const ProgramEnd lines =
      taut(folder, {"run", "small.toml", "--frames", "1", "--no-picture", "--json-lines"});
  ASSERT_EQ(lines.exit_code, 0) << lines.err;
  int steps = 0;
  for (const std::string& line : lines_of(lines.out))
    EXPECT_EQ(nlohmann::json::parse(line).at("step"), ++steps);
  EXPECT_EQ(steps, 3);
}

TEST(Run, SceneItWroteRunsToTheSameBits) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(
      taut(folder, {"run", "small.toml", "--out", "a", "--quiet", "--no-picture", "--threads", "1"})
          .exit_code,
      0);
  ASSERT_EQ(taut(folder,
                 {"run", "a/scene.toml", "--out", "b", "--quiet", "--no-picture", "--threads", "2"})
                .exit_code,
            0);
  EXPECT_EQ(read_text(folder / "a/frames/000006.npy"), read_text(folder / "b/frames/000006.npy"));
}

TEST(Run, ErrorsGoToStderrAndLeaveNothing) {
  const WorkFolder folder;
  folder.file("broken.toml", std::string(small_scene()) + "colour = \"red\"\n");
  const ProgramEnd broken = taut(folder, {"run", "broken.toml"});
  EXPECT_EQ(broken.exit_code, 1);
  EXPECT_EQ(broken.out, "");
  EXPECT_NE(broken.err.find("broken.toml:18:"), std::string::npos) << broken.err;
  EXPECT_NE(broken.err.find("colour"), std::string::npos) << broken.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));

  const ProgramEnd missing = taut(folder, {"run", "nowhere.toml"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find("nowhere.toml"), std::string::npos);
}

TEST(Run, LeavesFoldersOfOthersAlone) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  std::filesystem::create_directories(folder / "mine");
  folder.file("mine/thesis.txt", "years of work");
  const ProgramEnd end = taut(folder, {"run", "small.toml", "--out", "mine"});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_EQ(names_in(folder / "mine"), Names{"thesis.txt"});
}

// Long enough to be caught in the middle, three steps a frame; the first one made runs to its end
// without a break.
class Interrupted : public testing::Test {
 protected:
  static const WorkFolder& folder() {
    static const WorkFolder made;
    if (!std::filesystem::exists(made / "whole")) {
      made.file("small.toml", small_scene());
      EXPECT_EQ(taut(made, run_into("whole")).exit_code, 0);
    }
    return made;
  }
  static Names run_into(const std::string& out) {
    return {"run", "small.toml", "--frames", "120", "--quiet", "--no-picture", "--out", out};
  }

  // Starts a run and sends a signal when some frames are there.
  ProgramEnd run_and_signal(int signal) const {
    std::filesystem::remove_all(folder() / "cut");
    const RunningProgram program(folder(), run_into("cut"));
    EXPECT_TRUE(RunningProgram::wait_until(
        [&] { return std::filesystem::exists(folder() / "cut/frames/000004.npy"); }));
    program.send(signal);
    const ProgramEnd end = program.wait();
    EXPECT_FALSE(std::filesystem::exists(folder() / "cut/frames/000120.npy"))
        << "too fast to be interrupted";
    return end;
  }
  void expect_same_file(const std::string& name) const {
    EXPECT_EQ(read_text(folder() / ("cut/" + name)), read_text(folder() / ("whole/" + name)))
        << name;
  }
  void expect_valid_up_to_here() const {
    const auto summary = nlohmann::json::parse(read_text(folder() / "cut/summary.json"));
    EXPECT_EQ(summary.at("status"), "interrupted");
    int frames = 0;
    for (const std::string& name : names_in(folder() / "cut/frames")) {
      // an unfinished one, or a temporary file, would have no equal
      expect_same_file("frames/" + name);
      frames += std::isdigit(static_cast<unsigned char>(name[0])) != 0;
    }
    EXPECT_EQ(summary.at("frames"), frames);
    EXPECT_EQ(read_text(folder() / "cut/stats.csv").back(), '\n');
  }
  void expect_resumed_to_the_same_bits() const {
    const ProgramEnd resumed = taut(folder(), {"resume", "cut", "--quiet", "--no-picture"});
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_EQ(names_in(folder() / "cut/frames"), names_in(folder() / "whole/frames"));
    for (const char* name : {"frames/000119.npy", "frames/000120.npy", "checkpoint/state.bin"})
      expect_same_file(name);
    const Names a = lines_of(read_text(folder() / "cut/stats.csv")),
                b = lines_of(read_text(folder() / "whole/stats.csv"));
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t row = 1; row < a.size(); ++row)
      for (const int column : {0, 1, 2, 4, 5, 6, 9, 10, 17, 18, 19})
        EXPECT_EQ(fields_of(a[row])[column], fields_of(b[row])[column]) << row << " " << column;
  }
};

TEST_F(Interrupted, StopsCleanlyOnCtrlCAndResumesToTheSameBits) {
  const ProgramEnd end = run_and_signal(SIGINT);
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_NE(end.err.find("taut resume cut"), std::string::npos) << end.err;
  expect_valid_up_to_here();
  expect_resumed_to_the_same_bits();
}

TEST_F(Interrupted, StopsCleanlyWhenTerminated) {
  EXPECT_EQ(run_and_signal(SIGTERM).exit_code, 1);
  expect_valid_up_to_here();
}

TEST_F(Interrupted, ResumesAfterAKill) {
  EXPECT_EQ(run_and_signal(SIGKILL).exit_code, -1);
  expect_resumed_to_the_same_bits();
}

TEST(Resume, SaysWhatIsMissingOrDamaged) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  EXPECT_EQ(taut(folder, {"resume", "nothing"}).exit_code, 1);
  ASSERT_EQ(
      taut(folder, {"run", "small.toml", "--out", "r", "--frames", "1", "--quiet", "--no-picture"})
          .exit_code,
      0);
  std::string state = read_text(folder / "r/checkpoint/state.bin");
  state[state.size() / 2] ^= 1;
  folder.file("r/checkpoint/state.bin", state);
  const ProgramEnd damaged = taut(folder, {"resume", "r"});
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_NE(damaged.err.find("state.bin"), std::string::npos) << damaged.err;
}

TEST(Check, TellsErrorsFromDoubtsAndWritesNothing) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const ProgramEnd good = taut(folder, {"check", "small.toml"});
  EXPECT_EQ(good.exit_code, 0);
  EXPECT_NE(good.out.find("72 nodes"), std::string::npos) << good.out;
  const ProgramEnd bad = taut(folder, {"check", "small.toml", "--set", "time.step=-1"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_EQ(bad.out, "");
  EXPECT_NE(bad.err.find("step"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace
}  // namespace taut::test
