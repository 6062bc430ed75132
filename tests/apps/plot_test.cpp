// taut plot, and the benches' --json and --plot.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "program.h"

namespace taut::test {
namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

const std::string scenes = std::string(TAUT_SOURCE_DIR) + "/scenes";

int count_of(const std::string& text, const std::string& part) {
  int n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(Plot, DrawsARunOverTime) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"run", "small.toml", "--quiet", "--no-picture"}).exit_code, 0);
  const ProgramEnd end = taut(folder, {"plot", "out/small"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_EQ(end.out, "out/small/stats.svg\n");
  const std::string svg = read_text(folder / "out/small/stats.svg");
  for (const char* text :
       {">iterations<", ">bound<", ">ms a step<", ">factorisation<", ">energy, J<", ">kinetic<",
        ">max stretch<", ">contacts<", ">simulated time, s<", ">18 steps<"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  ASSERT_EQ(taut(folder, {"plot", "out/small", "--out", "p/s.png"}).exit_code, 0);
  EXPECT_EQ(read_text(folder / "p/s.png").substr(1, 3), "PNG");
  EXPECT_EQ(names_in(folder / "p"), Names{"s.png"});
  // The drawing belongs to the result: a new run may take its place.
  EXPECT_EQ(taut(folder, {"run", "small.toml", "--quiet", "--no-picture"}).exit_code, 0);
}

TEST(Plot, DrawsWhatThereIsOfARunThatHasNotEnded) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"run", "small.toml", "--quiet", "--no-picture"}).exit_code, 0);
  std::filesystem::remove(folder / "out/small/summary.json");
  const std::string stats = read_text(folder / "out/small/stats.csv");
  folder.file("out/small/stats.csv", stats.substr(0, stats.size() - 9));
  const ProgramEnd end = taut(folder, {"plot", "out/small"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_NE(read_text(folder / "out/small/stats.svg").find(">17 steps; the run has not ended"),
            std::string::npos);

  std::filesystem::remove(folder / "out/small/stats.svg");
  const std::vector<std::pair<std::string, std::string>> bad{
      {stats.substr(0, stats.find('\n') + 1), "no step"},
      {stats.substr(0, 7), "no whole line"},
      {stats.substr(0, stats.find('\n') + 1) + "1,2,3\n", "stats.csv:2"},
      {"a,b\n1,2\n", "'time'"}};
  for (const auto& [content, said] : bad) {
    folder.file("out/small/stats.csv", content);
    const ProgramEnd refused = taut(folder, {"plot", "out/small"});
    EXPECT_EQ(refused.exit_code, 1) << said;
    EXPECT_NE(refused.err.find(said), std::string::npos) << refused.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "out/small/stats.svg"));
  }
}

TEST(Plot, RefusesWhatIsNoResult) {
  const WorkFolder folder;
  folder.file("empty.json", "{\"rows\": []}");
  folder.file("text.json", "no json");
  folder.file("foreign.json", "{\"rows\": [{\"solver\": \"mpcg\"}], \"bench\": \"something\"}");
  const std::vector<std::pair<Names, std::string>> bad{
      {{"."}, "stats.csv"},
      {{"nowhere"}, "nowhere"},
      {{"empty.json"}, "rows"},
      {{"text.json"}, "rows"},
      {{"foreign.json"}, "'something'"},
      {{"empty.json", "--out", "a.pdf"}, ".svg or .png"}};
  for (const auto& [what, said] : bad) {
    Names arguments{"plot"};
    arguments.insert(arguments.end(), what.begin(), what.end());
    const ProgramEnd end = taut(folder, arguments);
    EXPECT_EQ(end.exit_code, 1) << said;
    EXPECT_NE(end.err.find(said), std::string::npos) << end.err;
  }
}

TEST(Bench, ScaleMeasuresEachMethodAtEachSize) {
  const WorkFolder folder;
  const ProgramEnd end =
      taut(folder, {"bench", "scale", "--nodes", "441,1681", "--solver", "cholmod,core_pcg,mpcg",
                    "--scenes", scenes, "--json", "s.json", "--plot", "s.png"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_NE(end.out.find("n^"), std::string::npos);
  EXPECT_EQ(read_text(folder / "s.png").substr(1, 3), "PNG");
  const Json report = Json::parse(read_text(folder / "s.json"));
  ASSERT_EQ(report.at("rows").size(), 6u);
  for (const Json& row : report.at("rows")) {
    const std::string what = row.dump();
    EXPECT_LT(row.at("anorm_error"), 1e-6) << what;
    EXPECT_GT(row.at("memory_MB"), 0.0) << what;
    EXPECT_GT(row.at("to_1e-3_ms"), 0.0) << what;
    EXPECT_LE(row.at("to_1e-3_iterations"), row.at("to_1e-6_iterations")) << what;
    if (row.at("solver") == "cholmod") {
      EXPECT_EQ(row.at("to_1e-6_iterations"), 0);
    } else {
      EXPECT_GT(row.at("to_1e-3_iterations"), 0);
    }
  }
  // The same figure from the file.
  ASSERT_EQ(taut(folder, {"plot", "s.json"}).exit_code, 0);
  const std::string svg = read_text(folder / "s.svg");
  for (const char* text : {">cholmod<", ">core_pcg<", ">mpcg<", ">memory, MB<"})
    EXPECT_EQ(count_of(svg, std::string("<text") + text), 1) << text;
}

TEST(Bench, FlatnessSweepsTheCellsAndKeepsTheBound) {
  const WorkFolder folder;
  const ProgramEnd end =
      taut(folder, {"bench", "flatness", "--nodes", "169", "--k-stretch", "60,6000000", "--solver",
                    "cholmod,core_pcg", "--scenes", scenes, "--json", "f.json", "--plot", "f.svg"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_NE(end.out.find("held in all 24 cells"), std::string::npos) << end.out;
  EXPECT_NE(end.err.find("cell 24 of 24"), std::string::npos);
  const Json report = Json::parse(read_text(folder / "f.json"));
  ASSERT_EQ(report.at("rows").size(), 48u);
  std::map<double, double> rho;  // of h, at the paper's shear and bend
  for (const Json& row : report.at("rows")) {
    if (row.at("solver") != "core_pcg") continue;
    EXPECT_LE(row.at("to_1e-6_iterations"), row.at("bound_iterations")) << row.dump();
    EXPECT_LE(row.at("lambda_max"), 2.0 + 1e-9);
    EXPECT_GE(row.at("lambda_min").get<double>() * (1.0 + row.at("rho").get<double>()), 1.0 - 1e-9);
    if (row.at("k_shear") == 0.3 && row.at("k_stretch") == 60.0) rho[row.at("h")] = row.at("rho");
  }
  // rho grows with the square of the step (no spring is damped here).
  EXPECT_NEAR(rho.at(33e-3) / rho.at(1e-3), 33.0 * 33.0, 1e-6 * 33 * 33);
  const std::string svg = read_text(folder / "f.svg");
  for (const char* text :
       {">core_pcg to 1e-3<", ">cholmod to 1e-6<", ">6e+06<", ">16.7 ms   600 / 50<"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
}

TEST(Bench, Table2IsDrawnBesideThePaper) {
  const WorkFolder folder;
  const ProgramEnd end =
      taut(folder, {"bench", "table2", "--nodes", "1681", "--k-stretch", "60", "--steps", "1",
                    "--scenes", scenes, "--json", "t.json", "--plot", "t.svg"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const std::string svg = read_text(folder / "t.svg");
  for (const char* text :
       {">core_pcg<", ">paper: mpcg<", ">paper: core_pcg<", ">ball, 1681 nodes, IMEX<"})
    EXPECT_EQ(count_of(svg, std::string("<text") + text), 1) << text;
}

TEST(Bench, RefusesBeforeItMeasures) {
  const WorkFolder folder;
  for (const Names& arguments :
       {Names{"bench", "scale", "--scenes", scenes, "--plot", "s.pdf"},
        Names{"bench", "flatness", "--scenes", scenes, "--nodes", "170"},
        Names{"bench", "scale", "--scenes", scenes, "--nodes", "441", "--solver", "magic"}}) {
    const ProgramEnd end = taut(folder, arguments);
    EXPECT_EQ(end.exit_code, 1) << arguments.back();
    EXPECT_NE(end.err.find("taut: "), std::string::npos) << end.err;
  }
}

}  // namespace
}  // namespace taut::test
