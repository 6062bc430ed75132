// taut ccd FILE --type vf|ee

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program.h"
#include "test_data.h"

namespace taut::test {
namespace {

// A point that falls from z = 1 to `end` through the triangle in the plane z = 0.
std::string falling_point(int end, const std::string& truth) {
  std::string text;
  for (const int z : {1, end})
    text += "1,4,1,4," + std::to_string(z) + ",1" + truth + "\n0,1,0,1,0,1" + truth +
            "\n1,1,0,1,0,1" + truth + "\n0,1,1,1,0,1" + truth + "\n";
  return text;
}

TEST(CcdVerb, AnswersLineByLine) {
  const WorkFolder folder;
  folder.file("q.csv", falling_point(-1, "") + falling_point(2, ""));
  const ProgramEnd end = taut(folder, {"ccd", "q.csv", "--type", "vf"});
  EXPECT_EQ(end.exit_code, 0) << end.err;
  double time = 0.0;
  ASSERT_EQ(std::sscanf(end.out.c_str(), "0,1,%lf\n1,0,\n", &time), 1) << end.out;
  EXPECT_NEAR(time, 0.5, 1e-9);
  EXPECT_LE(time, 0.5);
  EXPECT_TRUE(end.out.ends_with("\n1,0,\n")) << end.out;
  EXPECT_NE(end.err.find("2 queries, 1 hits"), std::string::npos) << end.err;
  EXPECT_EQ(end.err.find("missed"), std::string::npos) << end.err;
}

TEST(CcdVerb, ComparesWithTrueAnswers) {
  const WorkFolder folder;
  folder.file("false.csv", falling_point(-1, ",0") + falling_point(2, ",0"));
  const ProgramEnd alarm = taut(folder, {"ccd", "false.csv", "--type", "vf", "--json"});
  EXPECT_EQ(alarm.exit_code, 0);
  EXPECT_NE(alarm.err.find("0 collisions missed, 1 false alarms"), std::string::npos) << alarm.err;
  const auto report = nlohmann::json::parse(alarm.out);
  EXPECT_EQ(report.at("false_alarms"), 1);
  EXPECT_EQ(report.at("rows").at(0).at("hit"), true);
  EXPECT_EQ(report.at("rows").at(1).contains("time"), false);
  folder.file("missed.csv", falling_point(2, ",1"));
  const ProgramEnd missed = taut(folder, {"ccd", "missed.csv", "--type", "vf"});
  EXPECT_EQ(missed.exit_code, 1);
  EXPECT_NE(missed.err.find("1 collisions missed, 0 false alarms"), std::string::npos)
      << missed.err;
  // Within the separation it is none.
  EXPECT_EQ(taut(folder, {"ccd", "missed.csv", "--type", "vf", "--separation", "1.5"}).exit_code,
            0);
}

TEST(CcdVerb, MissesNothingOfTheDataSet) {
  const auto data = data_folder();
  if (!data) GTEST_SKIP() << "no data folder: set TAUT_DATA";
  const WorkFolder folder;
  int queries = 0;
  for (const auto& [name, type] : {std::pair{"vertex-face", "vf"}, std::pair{"edge-edge", "ee"}})
    for (const auto& entry : std::filesystem::directory_iterator(*data / "ccd/unit-tests" / name)) {
      const ProgramEnd end =
          taut(folder, {"ccd", entry.path().string(), "--type", type, "--json", "r.json"});
      EXPECT_EQ(end.exit_code, 0) << end.err;
      const auto report = nlohmann::json::parse(read_text(folder / "r.json"));
      queries += report.at("queries").get<int>();
      EXPECT_EQ(report.at("missed"), 0);
      EXPECT_EQ(report.at("false_alarms"), 0);
      EXPECT_EQ(std::ranges::count(end.out, '\n'), report.at("queries").get<int>());
    }
  EXPECT_EQ(queries, 324);
}

TEST(CcdVerb, BadFilesAndBadUsage) {
  const WorkFolder folder;
  folder.file("bad.csv", "1,1,2,1,3,oops\n");
  const ProgramEnd bad = taut(folder, {"ccd", "bad.csv", "--type", "ee"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_NE(bad.err.find("bad.csv:1:11:"), std::string::npos) << bad.err;
  EXPECT_TRUE(bad.out.empty());
  EXPECT_EQ(taut(folder, {"ccd", "none.csv", "--type", "ee"}).exit_code, 1);
  EXPECT_EQ(taut(folder, {"ccd", "bad.csv"}).exit_code, 2);
  EXPECT_EQ(taut(folder, {"ccd", "bad.csv", "--type", "xy"}).exit_code, 2);
  EXPECT_EQ(taut(folder, {"ccd", "--type", "ee"}).exit_code, 2);
  EXPECT_EQ(taut(folder, {"ccd", "bad.csv", "--type", "ee", "--tolerance", "-1"}).exit_code, 2);
}

}  // namespace
}  // namespace taut::test
