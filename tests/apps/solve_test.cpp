// taut dump and taut solve.

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "program.h"
#include "test_data.h"

namespace taut::test {
namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

// A small symmetric positive definite system, and one that is not definite.
const char* spd =
    "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 4\n2 1 -1\n2 2 4\n3 2 -1\n3 3 4\n";
const char* indefinite =
    "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 1\n2 1 2\n2 2 1\n";

std::map<std::string, Json> rows_by_solver(const std::string& json) {
  std::map<std::string, Json> rows;
  const Json report = Json::parse(json);
  for (const Json& row : report.at("rows")) rows[row.at("solver")] = row;
  EXPECT_FALSE(rows.empty());
  return rows;
}

TEST(Solve, PrintsTheCoresSpectrumBesideItsBound) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"dump", "small.toml", "--step", "5", "--out", "d", "--quiet"}).exit_code,
            0);
  const ProgramEnd end =
      taut(folder, {"solve", "d", "--solver", "auto,core_fast", "--spectrum", "--json"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const Json core = Json::parse(end.out).at("core");
  const double smallest = core.at("smallest"), largest = core.at("largest"), rho = core.at("rho");
  EXPECT_GE(smallest, 1.0 / (1.0 + rho) - 1e-9);
  EXPECT_LE(largest, 2.0 + 1e-9);
  EXPECT_LT(smallest, largest);
  EXPECT_LE(core.at("iterations").get<int>(), core.at("bound_iterations").get<int>());
  const auto rows = rows_by_solver(end.out);
  // With what has a place in the factor the core is larger, and it starts from rest.
  EXPECT_LE(rows.at("core_fast").at("iterations").get<int>(), core.at("iterations").get<int>());
  EXPECT_LE(rows.at("core_fast").at("iterations").get<int>(),
            rows.at("core_fast").at("bound_iterations").get<int>());
  EXPECT_EQ(rows.at("auto").at("method"), "core_fast");
}

TEST(Dump, WritesTheFilesThatAreDocumented) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  const ProgramEnd end = taut(
      folder, {"dump", "small.toml", "--step", "15", "--out", "d", "--set", "cloth.drag=1e-5"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_EQ(
      names_in(folder / "d"),
      (Names{"A.mtx", "A_core.mtx", "D_external.mtx", "K_bend.mtx", "K_shear.mtx", "K_stretch.mtx",
             "M.mtx", "S.mtx", "U.mtx", "b.mtx", "dv.mtx", "f.mtx", "friction.mtx", "guess.mtx",
             "meta.json", "springs.csv", "v.mtx", "x.mtx", "z.mtx"}));
  const Json meta = Json::parse(read_text(folder / "d/meta.json"));
  for (const char* key : {"h", "integrator", "compression", "bend_model", "core", "unknown",
                          "solver", "tolerance", "iterations", "relative_residual"})
    EXPECT_TRUE(meta.contains(key)) << key;
  EXPECT_EQ(meta.at("integrator"), "semi_implicit_euler");
  EXPECT_EQ(meta.at("h"), 5e-3);
  for (const char* name : {"A", "A_core", "K_stretch", "K_shear", "K_bend", "D_external"})
    EXPECT_TRUE(read_text(folder / ("d/" + std::string(name) + ".mtx"))
                    .starts_with("%%MatrixMarket matrix coordinate real symmetric\n"))
        << name;
  for (const char* name : {"S", "U"})
    EXPECT_TRUE(read_text(folder / ("d/" + std::string(name) + ".mtx"))
                    .starts_with("%%MatrixMarket matrix coordinate real general\n"))
        << name;
  for (const char* name : {"M", "b", "z", "x", "v", "f", "dv"}) {
    const std::string text = read_text(folder / ("d/" + std::string(name) + ".mtx"));
    EXPECT_TRUE(text.starts_with("%%MatrixMarket matrix array real general\n")) << name;
    EXPECT_NE(text.find("\n216 1\n"), std::string::npos) << name;
  }
}

TEST(Dump, AsksTheSolverThatWasNamed) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"dump", "small.toml", "--step", "2", "--out", "d", "--solver", "mpcg",
                          "--tolerance", "1e-9", "--quiet"})
                .exit_code,
            0);
  const Json meta = Json::parse(read_text(folder / "d/meta.json"));
  EXPECT_EQ(meta.at("solver"), "mpcg");
  EXPECT_EQ(meta.at("tolerance"), 1e-9);
  EXPECT_LT(meta.at("relative_residual").get<double>(), 1e-7);
}

TEST(Solve, AllMethodsAgreeOnADump) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"dump", "small.toml", "--step", "15", "--out", "d", "--quiet"}).exit_code,
            0);
  const ProgramEnd end = taut(folder, {"solve", "d", "--all", "--tolerance", "1e-10", "--json"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const Json report = Json::parse(end.out);
  EXPECT_TRUE(report.at("machine").contains("processor"));
  const auto rows = rows_by_solver(end.out);
  for (const char* name : {"mpcg", "upcg", "ppcg", "eq10", "eigen_ldlt", "core_pcg"})
    EXPECT_TRUE(rows.contains(name)) << name;
  EXPECT_FALSE(rows.contains("mpcg:diagonal"));  // the same as mpcg
  for (const auto& [name, row] : rows) {
    EXPECT_EQ(row.at("status"), "converged") << name;
    EXPECT_LT(row.at("anorm_error").get<double>(), 1e-7) << name;
    EXPECT_LT(row.at("relative_residual").get<double>(), 1e-7) << name;
    for (const char* key :
         {"scene", "nodes", "h", "integrator", "threads", "iterations", "setup_ms", "solve_ms",
          "total_ms", "memory_MB", "k_stretch", "precision"})
      EXPECT_TRUE(row.contains(key)) << name << " " << key;
  }
}

TEST(Solve, TakesSeparateFilesOfADump) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"dump", "small.toml", "--step", "15", "--out", "d", "--quiet"}).exit_code,
            0);
  const auto whole =
      rows_by_solver(taut(folder, {"solve", "d", "--solver", "core_pcg,mpcg", "--json"}).out);
  for (const char* constraints : {"d/S.mtx", "d/U.mtx"}) {
    const ProgramEnd end =
        taut(folder, {"solve", "--matrix", "d/A.mtx", "--rhs", "d/b.mtx", "--constraints",
                      constraints, "--z", "d/z.mtx", "--core", "d/A_core.mtx", "--guess",
                      "d/guess.mtx", "--solver", "core_pcg", "--solver", "mpcg", "--json"});
    ASSERT_EQ(end.exit_code, 0) << end.err;
    for (const auto& [name, row] : rows_by_solver(end.out))
      // S as it stands and S made from U differ in their last bits, and with them where the
      // iteration stops.
      EXPECT_NEAR(row.at("iterations").get<int>(), whole.at(name).at("iterations").get<int>(), 2)
          << name << " " << constraints;
  }
  // Without the core it is the preconditioner that is worse, not the answer.
  const auto plain = rows_by_solver(
      taut(folder, {"solve", "--matrix", "d/A.mtx", "--rhs", "d/b.mtx", "--constraints", "d/S.mtx",
                    "--z", "d/z.mtx", "--solver", "core_pcg", "--json"})
          .out);
  EXPECT_GT(plain.at("core_pcg").at("iterations"), whole.at("core_pcg").at("iterations"));
  EXPECT_LT(plain.at("core_pcg").at("anorm_error").get<double>(), 1e-4);
}

TEST(Solve, RefusesWhatDoesNotFitTogether) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"dump", "small.toml", "--step", "2", "--out", "d", "--quiet"}).exit_code,
            0);
  folder.file("short.mtx", "%%MatrixMarket matrix array real general\n2 1\n1\n2\n");
  folder.file("half.mtx", "%%MatrixMarket matrix coordinate real general\n216 216 1\n1 1 0.5\n");
  const std::vector<std::pair<Names, std::string>> refused{
      {{"solve", "d", "--rhs", "short.mtx"}, "short.mtx"},
      {{"solve", "d", "--core", "d/K_bend.mtx"}, "K_bend.mtx"},
      {{"solve", "d", "--constraints", "half.mtx"}, "half.mtx"},
      {{"solve", "--matrix", "d/A.mtx", "--z", "d/z.mtx"}, "--constraints"},
      {{"solve", "."}, "meta.json"},
      {{"solve", "--matrix", "nowhere.mtx"}, "nowhere.mtx"}};
  for (const auto& [arguments, named] : refused) {
    const ProgramEnd end = taut(folder, arguments);
    EXPECT_EQ(end.exit_code, 1) << named;
    EXPECT_EQ(end.out, "") << named;
    EXPECT_NE(end.err.find(named), std::string::npos) << end.err;
  }
}

TEST(Solve, DefaultRightHandSideIsTheMatrixTimesOnes) {
  const WorkFolder folder;
  folder.file("A.mtx", spd);
  folder.file("b.mtx", "%%MatrixMarket matrix array real general\n3 1\n3\n2\n3\n");
  folder.file("ones.mtx", "%%MatrixMarket matrix array real general\n3 1\n1\n1\n1\n");
  // Started at the answer, nothing is left to do.
  for (const Names& rhs : {Names{}, Names{"--rhs", "b.mtx"}}) {
    Names arguments{"solve",    "--matrix", "A.mtx", "--guess",
                    "ones.mtx", "--solver", "mpcg",  "--json"};
    arguments.insert(arguments.end(), rhs.begin(), rhs.end());
    const ProgramEnd end = taut(folder, arguments);
    ASSERT_EQ(end.exit_code, 0) << end.err;
    EXPECT_EQ(rows_by_solver(end.out).at("mpcg").at("iterations"), 0);
  }
}

TEST(Solve, SaysWhichSolverFailedAndWhy) {
  const WorkFolder folder;
  folder.file("A.mtx", indefinite);
  folder.file("b.mtx", "%%MatrixMarket matrix array real general\n2 1\n1\n-1\n");
  const ProgramEnd end =
      taut(folder, {"solve", "--matrix", "A.mtx", "--rhs", "b.mtx", "--solver", "eigen_ldlt,mpcg"});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_NE(end.out.find("no reference solution"), std::string::npos) << end.out;
  EXPECT_NE(end.err.find("eigen_ldlt: not_positive_definite"), std::string::npos) << end.err;
  EXPECT_NE(end.err.find("mpcg: not_positive_definite"), std::string::npos) << end.err;
  // One of several failing is a failure too.
  folder.file("B.mtx", spd);
  const ProgramEnd one = taut(folder, {"solve", "--matrix", "B.mtx", "--solver", "mpcg,eigen_ldlt",
                                       "--max-iterations", "1"});
  EXPECT_EQ(one.exit_code, 1);
  EXPECT_NE(one.err.find("mpcg: max_iterations"), std::string::npos) << one.err;
  EXPECT_EQ(one.err.find("eigen_ldlt"), std::string::npos) << one.err;
}

TEST(Solve, HistoryHoldsEveryIteration) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  ASSERT_EQ(taut(folder, {"dump", "small.toml", "--step", "15", "--out", "d", "--quiet"}).exit_code,
            0);
  const ProgramEnd end = taut(folder, {"solve", "d", "--solver", "mpcg,core_pcg", "--history",
                                       "h.csv", "--json", "s.json"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  // the table stays on stdout when the JSON goes to a file
  EXPECT_NE(end.out.find("mpcg"), std::string::npos);
  const auto rows = rows_by_solver(read_text(folder / "s.json"));
  const Names history = lines_of(read_text(folder / "h.csv"));
  ASSERT_EQ(history[0], "solver,iteration,stop_value,residual,anorm_error,time_ms");
  std::map<std::string, Names> last;
  std::map<std::string, int> count;
  for (std::size_t k = 1; k < history.size(); ++k) {
    const Names fields = fields_of(history[k]);
    ASSERT_EQ(fields.size(), 6u);
    EXPECT_GE(std::stod(fields[5]), last.contains(fields[0]) ? std::stod(last[fields[0]][5]) : 0.0);
    EXPECT_EQ(std::stoi(fields[1]), count[fields[0]]++);
    last[fields[0]] = fields;
  }
  for (const auto& [name, fields] : last) {
    EXPECT_EQ(std::stoi(fields[1]), rows.at(name).at("iterations"));
    EXPECT_LE(std::stod(fields[2]), 1e-6);
    EXPECT_NEAR(std::stod(fields[4]), rows.at(name).at("anorm_error").get<double>(),
                1e-3 * std::stod(fields[4]));
    EXPECT_NEAR(std::stod(fields[5]), rows.at(name).at("total_ms").get<double>(),
                1e-4 * std::stod(fields[5]));
  }
  EXPECT_EQ(last.size(), 2u);
}

struct Foreign {
  std::string file;
  double largest_iterative_error;  // A-norm, of those that converge at tolerance 1e-6
};

TEST(Solve, MatricesOfOthers) {
  const auto data = data_folder();
  if (!data) GTEST_SKIP() << "no data folder: set TAUT_DATA";
  const WorkFolder folder;
  for (const Foreign& foreign : {Foreign{"1138_bus.mtx", 1e-3},
                                 {"LFAT5.mtx", 1e-3},
                                 {"bcsstk13.mtx.gz", 1e-2},
                                 {"ani1.mtx", 1e-4},
                                 {"isai_spd.mtx", 1e-3}}) {
    const ProgramEnd end =
        taut(folder, {"solve", "--matrix", (*data / "matrices" / foreign.file).string(), "--all",
                      "--repeat", "1", "--time-limit", "3", "--json"});
    bool all_converged = true;
    for (const auto& [name, row] : rows_by_solver(end.out)) {
      const std::string status = row.at("status"), what = foreign.file + " " + name + " " + status;
      all_converged = all_converged && status == "converged";
      if (name == "cholmod" || name == "cholmod_reused_analysis" || name == "block_cholesky" ||
          name == "eigen_ldlt") {
        EXPECT_EQ(status, "converged") << what;
        EXPECT_LT(row.at("relative_residual").get<double>(), 1e-12) << what;
        EXPECT_LT(row.at("anorm_error").get<double>(), 1e-10) << what;
        continue;
      }
      EXPECT_TRUE(status == "converged" || status == "max_iterations" || status == "breakdown")
          << what;
      if (status == "converged") {
        EXPECT_LT(row.at("anorm_error").get<double>(), foreign.largest_iterative_error) << what;
      }
    }
    EXPECT_EQ(end.exit_code, all_converged ? 0 : 1) << foreign.file;
  }
}

TEST(Solve, ZeniosIsRefusedWithAReason) {
  const auto data = data_folder();
  if (!data) GTEST_SKIP() << "no data folder: set TAUT_DATA";
  const WorkFolder folder;
  const ProgramEnd end =
      taut(folder, {"solve", "--matrix", (*data / "matrices/zenios.mtx").string(), "--all"});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_EQ(end.out, "");
  EXPECT_NE(end.err.find("diagonal entry (1, 1) is zero"), std::string::npos) << end.err;
}

}  // namespace
}  // namespace taut::test
