// taut check and taut run with --untangle: what they say, what they write, and that they refuse
// what they cannot do.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program.h"
#include "scene/tangled_scenes.h"

namespace taut::test {
namespace {

TEST(Untangle, CheckSaysWhatItMovesAndWritesTheStart) {
  const WorkFolder folder;
  folder.file("slipped.toml", slipped_scene());
  const ProgramEnd refused = taut(folder, {"check", "slipped.toml"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("--untangle"), std::string::npos) << refused.err;

  const ProgramEnd said = taut(folder, {"check", "slipped.toml", "--untangle"});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  for (const char* part : {"untangled:", "none now", "worst stretch", "--out FILE.obj"})
    EXPECT_NE(said.out.find(part), std::string::npos) << said.out;
  EXPECT_EQ(names_in(folder.path()),
            (std::vector<std::string>{".stderr", ".stdout", "slipped.toml"}))
      << "writes nothing unasked";

  const ProgramEnd written =
      taut(folder, {"check", "slipped.toml", "--untangle", "--out", "start.obj"});
  ASSERT_EQ(written.exit_code, 0) << written.err;
  for (const char* name : {"start_low.obj", "start_high.obj"})
    EXPECT_NE(written.out.find(name), std::string::npos) << written.out;
  int vertices = 0;
  for (const std::string& line : lines_of(read_text(folder / "start_high.obj")))
    vertices += line.starts_with("v ");
  EXPECT_EQ(vertices, 169);
}

TEST(Untangle, RunStartsFromTheRepairedState) {
  const WorkFolder folder;
  folder.file("slipped.toml", slipped_scene());
  EXPECT_EQ(taut(folder, {"run", "slipped.toml", "--no-picture"}).exit_code, 1);
  const ProgramEnd ran = taut(folder, {"run", "slipped.toml", "--untangle", "--no-picture", "--out",
                                       "a", "--threads", "1"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_NE(ran.err.find("untangled:"), std::string::npos) << ran.err;
  const auto summary = nlohmann::json::parse(read_text(folder / "a/summary.json"));
  EXPECT_GT(summary.at("untangled").at("intersections"), 0);
  EXPECT_GT(summary.at("untangled").at("nodes_moved"), 10);
  const auto rows = lines_of(read_text(folder / "a/stats.csv"));
  const auto columns = fields_of(rows[0]);
  const auto at = std::ranges::find(columns, "intersections") - columns.begin();
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t k = 1; k < rows.size(); ++k) EXPECT_EQ(fields_of(rows[k])[at], "0");

  // The scene that it wrote does the same, with any number of threads.
  ASSERT_EQ(taut(folder,
                 {"run", "a/scene.toml", "--no-picture", "--quiet", "--out", "b", "--threads", "2"})
                .exit_code,
            0);
  for (const char* frame : {"000000.npy", "000002.npy"})
    EXPECT_EQ(read_text(folder / ("a/frames/" + std::string(frame))),
              read_text(folder / ("b/frames/" + std::string(frame))));
}

TEST(Untangle, WhatItCannotDoLeavesNothing) {
  const WorkFolder folder;
  folder.file("through.toml", pierced_scene());
  const ProgramEnd end =
      taut(folder, {"check", "through.toml", "--untangle", "--out", "start.obj"});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_NE(end.err.find("cannot be drawn apart"), std::string::npos) << end.err;
  EXPECT_EQ(names_in(folder.path()),
            (std::vector<std::string>{".stderr", ".stdout", "through.toml"}));
}

}  // namespace
}  // namespace taut::test
