// taut solve --all: every solver gives the same answer, on cloth and on other people's matrices, or
// says that it has none.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program.h"
#include "test_data.h"

namespace taut::test {
namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

// By value: what a range-for runs over must outlive its expression.
Json rows_of(const std::string& report) { return Json::parse(report).at("rows"); }

// All solvers on a dump of one step: converged, A-norm error below 1e-6 at tolerance 1e-9.
void expect_one_answer(const WorkFolder& folder, const std::string& scene, const Names& settings,
                       const char* step, int pinned_dofs, bool in_contact) {
  Names dump{"dump", scene, "--step", step, "--out", "d", "--quiet"};
  for (const std::string& setting : settings) dump.insert(dump.end(), {"--set", setting});
  const ProgramEnd dumped = taut(folder, dump);
  ASSERT_EQ(dumped.exit_code, 0) << dumped.err;
  const ProgramEnd end =
      taut(folder, {"solve", "d", "--all", "--tolerance", "1e-9", "--repeat", "1", "--json"});
  EXPECT_EQ(end.exit_code, 0) << end.err;
  const Json rows = Json::parse(end.out).at("rows");
  EXPECT_GE(rows.size(), 20u);
  for (const Json& row : rows) {
    const std::string what = scene + ": " + row.at("solver").get<std::string>();
    EXPECT_EQ(row.at("status"), "converged") << what;
    EXPECT_LT(row.at("anorm_error").get<double>(), 1e-6) << what;
    EXPECT_EQ(row.at("solves"), 1) << what;
  }
  // A node in contact has two free directions at most.
  const int constrained = rows[0].at("unknowns").get<int>() - rows[0].at("free_dofs").get<int>();
  EXPECT_GE(constrained, pinned_dofs) << scene;
  EXPECT_EQ(constrained > pinned_dofs, in_contact) << scene;
}

std::string scene_file(const char* name) {
  return std::string(TAUT_SOURCE_DIR) + "/scenes/" + name;
}

TEST(SolveAll, Pinned) {
  expect_one_answer(WorkFolder(), scene_file("pinned.toml"), {"cloth.grid.nodes=[13,13]"}, "40", 12,
                    false);
}
TEST(SolveAll, Drape) {
  expect_one_answer(WorkFolder(), scene_file("drape.toml"), {"cloth.grid.nodes=[17,17]"}, "60", 0,
                    true);
}
TEST(SolveAll, Ball) {
  expect_one_answer(WorkFolder(), scene_file("ball.toml"), {"cloth.grid.nodes=[17,17]"}, "30", 6,
                    true);
}

TEST(SolveAll, TShirt) {
  const auto data = data_folder();
  if (!data) GTEST_SKIP() << "no data folder: set TAUT_DATA";
  const WorkFolder folder;
  folder.file("tshirt.toml",
              "title = \"T-shirt on a ball\"\n[time]\nstep = 4e-3\nframes = 20\nsteps_per_frame = "
              "5\n[[cloth]]\nname = \"tshirt\"\nmesh = \"" +
                  (*data / "tshirt/tshirt.obj").string() +
                  "\"\nscale = 0.01\nup = \"y\"\ndensity = 0.2\nk_stretch = 2000\nk_bend = "
                  "0.01\n[[solid]]\nshape = \"sphere\"\nradius = 0.6\n"
                  "translation = [0, 0.04, 0.43]\nfriction = 0.3\n");
  expect_one_answer(folder, "tshirt.toml", {}, "16", 0, true);
}

class OthersMatrices : public ::testing::TestWithParam<const char*> {};

TEST_P(OthersMatrices, ResidualOrAnHonestNo) {
  const auto data = data_folder();
  if (!data) GTEST_SKIP() << "no data folder: set TAUT_DATA";
  const WorkFolder folder;
  const ProgramEnd end =
      taut(folder, {"solve", "--matrix", (*data / "matrices" / GetParam()).string(), "--all",
                    "--tolerance", "1e-9", "--time-limit", "10", "--repeat", "1", "--json"});
  bool all_converged = true;
  int converged = 0;
  for (const Json& row : rows_of(end.out)) {
    const std::string solver = row.at("solver"), what = solver + " on " + GetParam();
    const bool ok = row.at("status") == "converged";
    all_converged = all_converged && ok;
    converged += ok;
    EXPECT_LT(row.at("total_ms").get<double>(), 25e3) << what;
    if (ok) {
      EXPECT_LE(row.at("relative_residual").get<double>(), 1e-9) << what;
    } else {
      EXPECT_NE(row.value("message", ""), "") << what;
      EXPECT_NE(end.err.find(solver + ": "), std::string::npos) << what;
    }
    // Rounding alone does not hinder a direct method here.
    if (solver == "cholmod" || solver == "eigen_ldlt" || solver == "block_cholesky") {
      EXPECT_TRUE(ok) << what;
    }
    if (solver == "block_cholesky") {
      EXPECT_LE(row.at("relative_residual").get<double>(), 1e-10) << what;
    }
  }
  EXPECT_GE(converged, 5);
  EXPECT_EQ(end.exit_code, all_converged ? 0 : 1);
}

INSTANTIATE_TEST_SUITE_P(Matrices, OthersMatrices,
                         ::testing::Values("1138_bus.mtx", "LFAT5.mtx", "ani1.mtx", "isai_spd.mtx",
                                           "bcsstk13.mtx.gz"),
                         [](const auto& tested) {
                           return std::string(tested.param)
                               .substr(0, std::string(tested.param).find('.'))
                               .insert(0, "m");
                         });

struct Refused {
  const char* what;
  const char* matrix;
  const char* rhs;  // empty: none
  Names said;
};

TEST(SolveRefusal, SaysWhatWasFoundWhere) {
  const std::string coordinate = "%%MatrixMarket matrix coordinate real ",
                    array = "%%MatrixMarket matrix array real general\n";
  const Refused cases[] = {
      {"not symmetric",
       "general\n2 2 4\n1 1 2\n1 2 -1\n2 1 -0.5\n2 2 2\n",
       "",
       {"(1, 2)", "-0.5", "symmetric"}},
      {"not square", "general\n2 3 2\n1 1 1\n2 2 1\n", "", {"2 rows and 3 columns", "square"}},
      {"NaN in the matrix", "symmetric\n2 2 2\n1 1 1\n2 2 nan\n", "", {"A.mtx:4", "nan"}},
      {"infinity in the matrix", "symmetric\n2 2 2\n1 1 inf\n2 2 1\n", "", {"A.mtx:3", "inf"}},
      {"empty row", "symmetric\n3 3 2\n1 1 1\n3 3 1\n", "", {"(2, 2)", "zero or missing"}},
      {"short right-hand side",
       "symmetric\n2 2 2\n1 1 1\n2 2 1\n",
       "3 1\n1\n1\n1\n",
       {"b.mtx", "3 rows", "2 rows"}},
      {"two right-hand sides",
       "symmetric\n2 2 2\n1 1 1\n2 2 1\n",
       "2 2\n1\n1\n1\n1\n",
       {"b.mtx", "2 columns", "1 column"}},
      {"NaN in the right-hand side",
       "symmetric\n2 2 2\n1 1 1\n2 2 1\n",
       "2 1\n1\nnan\n",
       {"b.mtx:4", "nan"}},
  };
  for (const Refused& refused : cases) {
    const WorkFolder folder;
    folder.file("A.mtx", coordinate + refused.matrix);
    Names arguments{"solve", "--matrix", "A.mtx", "--all"};
    if (*refused.rhs)
      folder.file("b.mtx", array + refused.rhs),
          arguments.insert(arguments.end(), {"--rhs", "b.mtx"});
    const ProgramEnd end = taut(folder, arguments);
    EXPECT_EQ(end.exit_code, 1) << refused.what;
    EXPECT_EQ(end.out, "") << refused.what;
    for (const std::string& said : refused.said)
      EXPECT_NE(end.err.find(said), std::string::npos) << refused.what << ": " << end.err;
  }
}

// A free chain of springs: constant vectors are its null space, and this b is not orthogonal to
// them, so there is no solution.
TEST(SolveRefusal, SingularIsReportedByEverySolver) {
  const WorkFolder folder;
  std::string matrix = "%%MatrixMarket matrix coordinate real symmetric\n6 6 11\n";
  for (int i = 1; i <= 6; ++i)
    matrix += std::to_string(i) + " " + std::to_string(i) + (i == 1 || i == 6 ? " 1\n" : " 2\n");
  for (int i = 1; i < 6; ++i) matrix += std::to_string(i + 1) + " " + std::to_string(i) + " -1\n";
  folder.file("A.mtx", matrix);
  folder.file("b.mtx", "%%MatrixMarket matrix array real general\n6 1\n1\n1\n1\n1\n1\n2\n");
  const ProgramEnd end =
      taut(folder, {"solve", "--matrix", "A.mtx", "--rhs", "b.mtx", "--all", "--json"});
  EXPECT_EQ(end.exit_code, 1);
  for (const Json& row : rows_of(end.out)) {
    EXPECT_NE(row.at("status"), "converged") << row.dump();
    EXPECT_NE(row.value("message", ""), "") << row.dump();
  }
}

// Symmetric, its diagonal positive, but with eigenvalues 1 +- 2.
TEST(SolveRefusal, IndefiniteIsReportedByEverySolverThatNeedsDefiniteness) {
  const WorkFolder folder;
  folder.file("A.mtx",
              "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 1\n2 1 2\n2 2 1\n");
  folder.file("b.mtx", "%%MatrixMarket matrix array real general\n2 1\n1\n-1\n");
  const ProgramEnd end =
      taut(folder, {"solve", "--matrix", "A.mtx", "--rhs", "b.mtx", "--all", "--json"});
  EXPECT_EQ(end.exit_code, 1);
  for (const Json& row : rows_of(end.out)) {
    // BiCGSTAB asks for no definiteness
    if (row.at("solver").get<std::string>().starts_with("eq10")) continue;
    EXPECT_NE(row.at("status"), "converged") << row.dump();
    EXPECT_NE(row.value("message", ""), "") << row.dump();
  }
}

TEST(SolveOptions, ResidualIsReachedWhereItIsAskedFor) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"dump", "small.toml", "--step", "15", "--out", "d", "--quiet"}).exit_code,
            0);
  const auto row = [&](const Names& more) {
    Names arguments{"solve", "d", "--solver", "upcg:amg", "--tolerance", "1e-2", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Json::parse(taut(folder, arguments).out).at("rows").at(0);
  };
  const Json loose = row({}), strict = row({"--residual", "1e-8"});
  EXPECT_GT(loose.at("relative_residual").get<double>(), 1e-8);
  EXPECT_LE(strict.at("relative_residual").get<double>(), 1e-8);
  EXPECT_GT(strict.at("iterations"), loose.at("iterations"));
  EXPECT_NE(strict.at("remark").get<std::string>().find("tolerance"), std::string::npos);
  // No method gets below rounding; that is said, not passed over.
  const Json impossible = row({"--residual", "1e-30"});
  EXPECT_NE(impossible.at("status"), "converged");
  EXPECT_NE(impossible.at("message"), "");
}

TEST(SolveOptions, ShortSolvesAreMediansOfFive) {
  const WorkFolder folder;
  folder.file("A.mtx",
              "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 4\n2 1 -1\n2 2 4\n3 2 "
              "-1\n3 3 4\n");
  const auto solves = [&](const Names& more) {
    Names arguments{"solve", "--matrix", "A.mtx", "--solver", "mpcg", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Json::parse(taut(folder, arguments).out).at("rows").at(0).at("solves").get<int>();
  };
  EXPECT_EQ(solves({}), 5);
  EXPECT_EQ(solves({"--repeat", "9"}), 9);
  EXPECT_NE(taut(folder, {"solve", "--matrix", "A.mtx", "--solver", "mpcg"}).out.find("solves"),
            std::string::npos);
}

TEST(SolveOptions, TimeLimitEndsASlowMethod) {
  const auto data = data_folder();
  if (!data) GTEST_SKIP() << "no data folder: set TAUT_DATA";
  const WorkFolder folder;
  const ProgramEnd end =
      taut(folder, {"solve", "--matrix", (*data / "matrices/bcsstk13.mtx.gz").string(), "--solver",
                    "mpcg", "--tolerance", "1e-12", "--time-limit", "0.05", "--json"});
  EXPECT_EQ(end.exit_code, 1);
  const Json row = Json::parse(end.out).at("rows").at(0);
  EXPECT_EQ(row.at("status"), "max_iterations");
  EXPECT_NE(row.at("message").get<std::string>().find("0.05 s"), std::string::npos);
  EXPECT_LT(row.at("solve_ms"), 500.0);
}

TEST(SolveOptions, PlotHasACurveAMethod) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"dump", "small.toml", "--step", "15", "--out", "d", "--quiet"}).exit_code,
            0);
  const ProgramEnd end = taut(folder, {"solve", "d", "--solver", "mpcg,core_pcg,eigen_ldlt",
                                       "--plot", "p.svg", "--json", "s.json"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const std::string svg = read_text(folder / "p.svg");
  for (const char* text : {">mpcg<", ">core_pcg<", ">eigen_ldlt<", ">time, ms<"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  EXPECT_EQ(taut(folder, {"plot", "s.json", "--out", "q.svg"}).exit_code, 0);
  // Refused before anything is solved.
  const ProgramEnd refused = taut(folder, {"solve", "d", "--all", "--plot", "p.pdf"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_EQ(refused.out, "");
  EXPECT_NE(refused.err.find("p.pdf"), std::string::npos);
}

}  // namespace
}  // namespace taut::test
