// What `taut run` shows while it works: in a terminal, in a log file, as JSON lines.

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "program.h"

namespace taut::test {
namespace {

// What a terminal of this width is sent. stdout and stderr both go to it.
std::string in_terminal(const WorkFolder& folder, unsigned short columns,
                        std::vector<std::string> arguments) {
  winsize size{};
  size.ws_col = columns, size.ws_row = 24;
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    std::vector<char*> argv{const_cast<char*>(TAUT_PROGRAM)};
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    if (::chdir(folder.path().c_str()) == 0) ::execv(TAUT_PROGRAM, argv.data());
    ::_exit(127);
  }
  std::string seen;
  char piece[4096];
  for (ssize_t n; (n = ::read(terminal, piece, sizeof piece)) > 0;)
    seen.append(piece, static_cast<std::size_t>(n));
  int state = 0;
  ::waitpid(child, &state, 0);
  ::close(terminal);
  EXPECT_TRUE(WIFEXITED(state) && WEXITSTATUS(state) == 0) << seen;
  return seen;
}

// The lines that were written over each other: from a carriage return to the erasing of what was
// left of the one before.
std::vector<std::string> bars_of(const std::string& seen) {
  std::vector<std::string> bars;
  static const std::regex bar("\r(\\[[^\r\n\x1b]*)\x1b\\[K");
  for (std::sregex_iterator at(seen.begin(), seen.end(), bar), end; at != end; ++at)
    bars.push_back((*at)[1]);
  return bars;
}

std::vector<std::string> quick_run(const std::string& out) {
  return {"run", "small.toml", "--frames", "40", "--no-picture", "--out", out};
}

TEST(Progress, TerminalShowsABarThatFills) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const auto bars = bars_of(in_terminal(folder, 160, quick_run("a")));
  ASSERT_GE(bars.size(), 2u);
  EXPECT_EQ(bars.front().substr(0, 34), "[....................] frame 0/40 ");
  static const std::regex last(
      R"(\[#{20}\] frame 40/40  0 s left  t = 0\.600 s  [0-9.]+ steps/s  \d+ iterations  stretch \d+\.\d %  \d+ contacts)");
  EXPECT_TRUE(std::regex_match(bars.back(), last)) << bars.back();
}

TEST(Progress, NarrowTerminalIsNeverOverrun) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  for (const unsigned short columns : {100, 60, 30, 10}) {
    const auto bars = bars_of(in_terminal(folder, columns, quick_run("b")));
    ASSERT_GE(bars.size(), 2u) << columns;
    for (const std::string& bar : bars) EXPECT_LT(bar.size(), columns) << bar;
    if (columns >= 40) {
      EXPECT_NE(bars.back().find("frame 40/40"), std::string::npos) << bars.back();
    }
  }
}

TEST(Progress, LogFileGetsPlainLines) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const ProgramEnd end = taut(folder, quick_run("c"));
  ASSERT_EQ(end.exit_code, 0);
  EXPECT_EQ(end.err.find_first_of("\r\x1b["), std::string::npos) << end.err;
  auto lines = lines_of(end.err);
  std::erase_if(lines, [](const std::string& line) { return line.starts_with("note: "); });
  ASSERT_GE(lines.size(), 2u);
  EXPECT_TRUE(lines.front().starts_with("frame 0/40  ")) << lines.front();
  EXPECT_TRUE(lines.back().starts_with("frame 40/40  0 s left  t = 0.600 s  ")) << lines.back();
}

TEST(Progress, JsonLinesTellEveryStepAndResumeHasThemToo) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const ProgramEnd end =
      taut(folder, {"run", "small.toml", "--out", "d", "--no-picture", "--json-lines"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_EQ(end.err, "");
  const auto lines = lines_of(end.out), rows = lines_of(read_text(folder / "d/stats.csv"));
  ASSERT_EQ(lines.size(), 18u);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const auto line = nlohmann::json::parse(lines[k]);
    const auto row = fields_of(rows[k + 1]);
    EXPECT_EQ(line.at("step"), k + 1);
    EXPECT_EQ(line.at("steps"), 18);
    EXPECT_EQ(line.at("frame"), (k + 1) / 3);
    EXPECT_EQ(line.at("frames"), 6);
    EXPECT_EQ(std::to_string(line.at("iterations").get<int>()), row[9]);
    EXPECT_EQ(std::to_string(line.at("contacts").get<int>()), row[6]);
    EXPECT_NEAR(line.at("max_stretch").get<double>(), std::stod(row[19]),
                1e-5 * std::abs(std::stod(row[19])) + 1e-12);
    EXPECT_GE(line.at("left_s").get<double>(), 0.0);
  }
  EXPECT_EQ(nlohmann::json::parse(lines.back()).at("left_s"), 0.0);
  const ProgramEnd resumed = taut(folder, {"resume", "d", "--json-lines", "--no-picture"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(resumed.out + resumed.err, "");  // nothing was left to do
}

}  // namespace
}  // namespace taut::test
