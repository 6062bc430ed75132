// What holds for every verb: --help with an example, exit code 2 and a message on stderr for bad
// usage.

#include <gtest/gtest.h>

#include "program.h"

namespace taut::test {
namespace {

std::vector<std::string> verbs(const WorkFolder& folder) {
  std::vector<std::string> names;
  bool listed = false;
  for (const std::string& line : lines_of(taut(folder, {"--help"}).out)) {
    if (line.starts_with("Subcommands:"))
      listed = true;
    else if (listed && line.starts_with("  ") && line[2] != ' ')
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return names;
}

TEST(Usage, EveryVerbHasHelpWithAnExample) {
  const WorkFolder folder;
  const std::vector<std::string> names = verbs(folder);
  for (const char* verb :
       {"run", "resume", "check", "dump", "solve", "bench", "export", "plot", "ccd", "render"})
    EXPECT_TRUE(std::ranges::find(names, verb) != names.end())
        << verb << " is not listed by --help";
  for (const std::string& verb : names) {
    const ProgramEnd help = taut(folder, {verb, "--help"});
    EXPECT_EQ(help.exit_code, 0) << verb;
    EXPECT_NE(help.out.find("Example: taut " + verb), std::string::npos) << verb << "\n"
                                                                         << help.out;
    EXPECT_EQ(help.err, "") << verb;
  }
}

TEST(Usage, BadUsageIsExitCodeTwo) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const std::vector<std::vector<std::string>> bad{
      {},
      {"fly"},
      {"run"},
      {"run", "small.toml", "--frames", "-1"},
      {"run", "small.toml", "--frames", "many"},
      {"run", "small.toml", "--threads", "0"},
      {"run", "small.toml", "--colour"},
      {"resume"},
      {"check"},
      {"export", "out"},
      {"dump", "small.toml", "--out", "d"},
      {"dump", "small.toml", "--step", "0", "--out", "d"},
      {"solve"},
      {"plot"},
      {"bench"},
      {"bench", "flatness", "--k-stretch", "61"},
      {"bench", "scale", "--nodes", "-4"},
      {"solve", "d", "--matrix", "A.mtx"},
      {"solve", "--matrix", "A.mtx", "--solver", "magic"},
      {"solve", "--matrix", "A.mtx", "--solver", "mpcg", "--all"},
      {"solve", "--matrix", "A.mtx", "--tolerance", "0"}};
  for (const auto& arguments : bad) {
    const ProgramEnd end = taut(folder, arguments);
    std::string line;
    for (const std::string& a : arguments) line += a + " ";
    EXPECT_EQ(end.exit_code, 2) << line;
    EXPECT_EQ(end.out, "") << line;
    EXPECT_NE(end.err, "") << line;
  }
  EXPECT_EQ(names_in(folder.path()),
            (std::vector<std::string>{".stderr", ".stdout", "small.toml"}));
}

TEST(Usage, VersionIsTold) {
  const WorkFolder folder;
  const ProgramEnd end = taut(folder, {"--version"});
  EXPECT_EQ(end.exit_code, 0);
  EXPECT_TRUE(end.out.starts_with("taut ")) << end.out;
}

}  // namespace
}  // namespace taut::test
