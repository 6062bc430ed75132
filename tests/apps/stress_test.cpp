// taut bench contact --stress: runs, their judge, and how it ends.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program.h"

namespace taut::test {
namespace {

// A small falling sheet; crossed: with another one through it.
std::string sheets(bool crossed) {
  const std::string flat = R"(
[time]
frames = 2
steps_per_frame = 2
[contact]
allow_intersections = true
[[cloth]]
name = "flat"
grid = { nodes = [5, 5], origin = [-0.1, -0.1, 0], u = [0.2, 0, 0], v = [0, 0.2, 0] }
density = 0.15
)";
  const std::string upright = R"(
[[cloth]]
name = "upright"
grid = { nodes = [5, 5], origin = [-0.11, 0.01, -0.1], u = [0.2, 0, 0], v = [0, 0.005, 0.2] }
density = 0.15
)";
  return crossed ? flat + upright : flat;
}

ProgramEnd stress(const WorkFolder& folder, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"bench", "contact",  "--stress", "1",        "--scene",
                                     "clump", "--frames", "2",        "--scenes", "."};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return taut(folder, arguments);
}

std::string script(const WorkFolder& folder, const std::string& name, const std::string& text) {
  const std::filesystem::path path = folder.file(name, "#!/bin/sh\n" + text + "\n");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path.string();
}

TEST(StressVerb, AnIntersectionIsAFailure) {
  const WorkFolder folder;
  folder.file("clump.toml", sheets(true));
  const ProgramEnd end = stress(folder, {"--json", "stress.json"});
  EXPECT_EQ(end.exit_code, 1) << end.out;
  EXPECT_NE(end.err.find("2 of 2 runs had intersections"), std::string::npos) << end.err;
  for (const auto& row : nlohmann::json::parse(read_text(folder / "stress.json"))["rows"]) {
    EXPECT_EQ(row["steps"], 4);
    EXPECT_GT(row["intersections"].get<int>(), 0);
  }
}

TEST(StressVerb, TheJudgeSeesEveryFrameAndIsBelieved) {
  const WorkFolder folder;
  folder.file("clump.toml", sheets(false));
  const std::string content =
      script(folder, "content.sh", "echo \"$1 $2\" >> asked.txt; test -s \"$3\"");
  EXPECT_EQ(stress(folder, {"--judge", content}).exit_code, 0);
  EXPECT_EQ(read_text(folder / "asked.txt"),
            "--solid-from 25\n--solid-from 25\n--solid-from 25\n--solid-from 25\n--solid-from "
            "25\n--solid-from 25\n")
      << "the start and two frames of each of two runs";
  const ProgramEnd severe = stress(folder, {"--judge", script(folder, "severe.sh", "exit 1")});
  EXPECT_EQ(severe.exit_code, 1);
  EXPECT_NE(severe.out.find("judged: 3 of 3 frames intersecting"), std::string::npos) << severe.out;
  const ProgramEnd broken =
      stress(folder, {"--judge", script(folder, "broken.sh", "echo cannot read >&2; exit 3")});
  EXPECT_NE(broken.exit_code, 0);
  EXPECT_NE(broken.err.find("cannot read"), std::string::npos) << broken.err;
  const ProgramEnd nobody = stress(folder, {"--judge", "./nobody"});
  EXPECT_NE(nobody.exit_code, 0);
  EXPECT_NE(nobody.err.find("nobody"), std::string::npos) << nobody.err;
}

TEST(StressVerb, NothingToRunIsAnError) {
  const WorkFolder folder;
  const auto refusal = [&](const std::vector<std::string>& arguments) {
    const ProgramEnd end = stress(folder, arguments);
    EXPECT_EQ(end.exit_code, 1) << end.out;
    return end.err;
  };
  EXPECT_NE(refusal({}).find("no clump.toml in ."), std::string::npos);
  EXPECT_NE(refusal({"--scene", "clumb"}).find("clump, stack, twist"), std::string::npos);
  folder.file("clump.toml", "[[cloth]]\n");
  EXPECT_NE(refusal({}).find("clump.toml"), std::string::npos);
  std::filesystem::remove(folder / "clump.toml");
  const ProgramEnd none = taut(folder, {"bench", "contact", "--stress", "1", "--scenes", "."});
  EXPECT_EQ(none.exit_code, 1) << none.out;
  EXPECT_NE(none.err.find("has none of the contact scenes"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace taut::test
