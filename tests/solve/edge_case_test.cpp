// Systems with nothing to solve, and systems that cannot be solved: reported by every solver, never
// a crash and never silently wrong.

#include <gtest/gtest.h>

#include <limits>

#include "solve/constrained_case.h"
#include "taut/base/error.h"
#include "taut/linalg/sparse_cholesky.h"
#include "taut/solve/solver_registry.h"

namespace taut::test {
namespace {

class EdgeCase : public testing::TestWithParam<std::string> {
 protected:
  SolveSummary solve(const ConstrainedCase& c, std::vector<double>& x) {
    x.assign(c.b.size(), 1e300);
    return make_solver(solver_options(GetParam(), 1e-10))->solve(c.system(), x);
  }
  // Not ok, and x is S guess + (I-S) z or some iterate: finite, and as prescribed where it is
  // prescribed.
  void expect_refused(const ConstrainedCase& c, std::initializer_list<Outcome> allowed) {
    std::vector<double> x;
    const SolveSummary summary = solve(c, x);
    EXPECT_EQ(std::ranges::count(allowed, summary.status.outcome), 1)
        << name_of(summary.status.outcome) << ": " << summary.status.message;
    EXPECT_FALSE(summary.status.message.empty());
    EXPECT_TRUE(as_eigen(x).allFinite());
    EXPECT_LT((c.constraint_rows() * (as_eigen(x) - as_eigen(c.z))).norm(),
              1e-8 * (1.0 + as_eigen(x).norm()));
  }
  Random random_{1};
};

INSTANTIATE_TEST_SUITE_P(All, EdgeCase, testing::ValuesIn(solvers_to_test()),
                         [](const auto& solver) { return test_name(solver.param); });

TEST_P(EdgeCase, AllNodesFixed) {
  ConstrainedCase c = random_case(random_, {.nodes = 10, .only = 0});
  std::vector<double> x;
  SolveSummary summary = solve(c, x);
  EXPECT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_LT(relative_difference(x, as_eigen(c.z)), 1e-10);
  EXPECT_EQ(summary.relative_residual, 0.0);
  c.z.assign(c.z.size(), 0.0);
  summary = solve(c, x);
  EXPECT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_EQ(x, c.z);
}

TEST_P(EdgeCase, NothingDrives) {
  ConstrainedCase c = random_case(random_, {.nodes = 20});
  c.b.assign(c.b.size(), 0.0);
  // z only along free directions, where it does not count, or nowhere.
  for (const bool garbage : {false, true}) {
    const Eigen::VectorXd z = garbage ? Eigen::VectorXd(c.projection() * as_eigen(c.guess))
                                      : Eigen::VectorXd::Zero(c.size());
    c.z.assign(z.begin(), z.end());
    // what is left of z is rounding: no guess of size 1 comes within 1e-10 of that
    if (garbage) c.guess.clear();
    std::vector<double> x;
    const SolveSummary summary = solve(c, x);
    EXPECT_TRUE(summary.status.ok()) << summary.status.message;
    EXPECT_LT(as_eigen(x).norm(), garbage ? 1e-10 : 1e-300);
    if (!garbage) {
      EXPECT_EQ(summary.iterations, 0);
    }
  }
}

// Iterative methods must not try to reach a residual of zero times the right-hand side.
TEST_P(EdgeCase, OnlyTheGuessIsNotZero) {
  ConstrainedCase c = random_case(random_, {.nodes = 20});
  c.b.assign(c.b.size(), 0.0), c.z.assign(c.z.size(), 0.0);
  for (double& value : c.guess) value *= 1e6;
  std::vector<double> x;
  const SolveSummary summary = solve(c, x);
  EXPECT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_EQ(summary.iterations, 0);
  EXPECT_EQ(as_eigen(x).norm(), 0.0);
}

TEST_P(EdgeCase, NegativeMassIsReported) {
  ConstrainedCase c = random_case(random_, {.nodes = 20, .only = 3});
  for_each_entry(c.a, [](Index row, Index column, double& value) {
    if (row == column && row / 3 == 7) value = -value;
  });
  expect_refused(c, {Outcome::not_positive_definite});
}

// Its diagonal blocks are positive definite, it is not. BiCGSTAB needs no definiteness: it may
// solve this, and then rightly.
TEST_P(EdgeCase, IndefiniteMatrixIsReported) {
  ConstrainedCase c = random_case(random_, {.nodes = 20});
  for_each_entry(c.a, [](Index row, Index column, double& value) {
    if (row / 3 != column / 3) value *= 8.0;
  });
  const Eigen::MatrixXd u = c.dense_u();
  ASSERT_LT(
      (u.transpose() * dense(c.a) * u).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(),
      -1.0);
  if (!GetParam().starts_with("eq10")) return expect_refused(c, {Outcome::not_positive_definite});
  std::vector<double> x;
  if (solve(c, x).status.ok()) {
    EXPECT_LT(relative_difference(x, c.solution()), 1e-6);
  }
}

TEST_P(EdgeCase, NonFiniteNumbersAreReported) {
  const ConstrainedCase good = random_case(random_, {.nodes = 20});
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    ConstrainedCase c = good;
    c.b[31] = bad;
    expect_refused(c, {Outcome::not_finite});
    c = random_case(random_, {.nodes = 20, .only = 3});
    c.a.block(7, c.a.pattern->diagonal[7])[1] = bad;
    expect_refused(c, {Outcome::not_finite, Outcome::not_positive_definite});
    c = random_case(random_, {.nodes = 20, .only = 3});
    c.a.block(7, c.a.pattern->diagonal[7])[0] = bad;
    expect_refused(c, {Outcome::not_finite, Outcome::not_positive_definite});
  }
}

TEST_P(EdgeCase, NonFiniteGuessIsNoGuess) {
  ConstrainedCase c = random_case(random_, {.nodes = 20});
  c.guess[10] = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> x;
  const SolveSummary summary = solve(c, x);
  EXPECT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_LT(relative_difference(x, c.solution()), 1e-7);
  EXPECT_NE(summary.remark.find("guess"), std::string::npos) << summary.remark;
}

TEST_P(EdgeCase, IterationLimitIsReported) {
  const ConstrainedCase c = random_case(random_, {.nodes = 60, .only = 3, .margin = 1e-4});
  SolverOptions options = solver_options(GetParam(), 1e-12);
  options.max_iterations = 2;
  const auto solver = make_solver(options);
  int calls = 0;
  solver->observer = [&](int iteration, double, std::span<const double>) {
    EXPECT_EQ(iteration, ++calls);
  };
  std::vector<double> x(c.b.size());
  const SolveSummary summary = solver->solve(c.system(), x);
  if (GetParam() == "auto") {  // it has something to fall back on
    EXPECT_TRUE(summary.status.ok());
    EXPECT_EQ(summary.method, "block_cholesky");
    return;
  }
  EXPECT_EQ(calls, summary.iterations);
  if (summary.status.ok()) {
    EXPECT_EQ(summary.iterations, 0);  // a direct method
    return;
  }
  EXPECT_EQ(summary.status.outcome, Outcome::max_iterations);
  EXPECT_EQ(summary.iterations, 2);
  EXPECT_GT(summary.relative_residual, 1e-10);
}

std::string refusal(const std::string& name) {
  try {
    make_solver(solver_options(name, 1e-3));
  } catch (const InputError& error) {
    return error.what();
  }
  return "made";
}

bool says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

TEST(UnknownSolver, ListsTheNamesAndSuggestsOne) {
  const std::string message = refusal("core_pgc");
  EXPECT_TRUE(says(message, "'core_pgc'") && says(message, "did you mean 'core_pcg'?")) << message;
  for (const std::string& name : solver_names()) EXPECT_TRUE(says(message, name)) << message;
  EXPECT_FALSE(says(refusal("gauss"), "did you mean"));
  EXPECT_TRUE(says(refusal(""), "unknown solver"));
}

TEST(UnknownSolver, SaysWhatIsNotBuiltIn) {
  const bool built_in = make_cholesky("cholmod") != nullptr;
  for (const std::string name : {"cholmod", "core_pcg:cholmod"}) {
    const std::string message = refusal(name);
    EXPECT_EQ(message == "made", built_in);
    if (!built_in) {
      EXPECT_TRUE(says(message, "TAUT_WITH_CHOLMOD")) << message;
    }
    EXPECT_EQ(std::ranges::count(solver_names(), name), built_in ? 1 : 0);
  }
  // pardiso_cgs is not made in libtaut at all: its library registers it.
  const bool pardiso = make_cholesky("pardiso") != nullptr;
  for (const std::string name : {"pardiso", "pardiso_cgs", "core_pcg:pardiso"}) {
    EXPECT_TRUE(is_solver_name(name));
    const std::string message = refusal(name);
    EXPECT_EQ(message == "made", pardiso);
    if (!pardiso) {
      EXPECT_TRUE(says(message, "./taut setup pardiso")) << message;
    }
    EXPECT_EQ(std::ranges::count(solver_names(), name), pardiso ? 1 : 0);
  }
  // The default backend falls back, and says so.
  Random random(9);
  const ConstrainedCase c = random_case(random, {.nodes = 5});
  std::vector<double> x(c.b.size());
  const SolveSummary summary = make_solver(solver_options("core_pcg", 1e-3))->solve(c.system(), x);
  EXPECT_EQ(says(summary.remark, "Eigen"), !built_in) << summary.remark;
}

// A chain that nothing holds: singular, but rounding leaves a last pivot that may be a little above
// zero.
TEST(SingularMatrix, IsNotSolvedByADirectMethod) {
  BlockCsr a(make_pattern({{1}, {0, 2}, {1}}, 1));
  const double k[] = {0.1, 0.2};
  for_each_entry(a, [&](Index r, Index c, double& value) {
    value = r != c ? -k[std::min(r, c)] : r == 0 ? k[0] : r == 1 ? k[0] + k[1] : k[1];
  });
  const std::vector<double> b{1.0, 0.0, 0.0};
  LinearSystem system;
  system.matrix = &a, system.rhs = b;
  for (const std::string& name : solver_names()) {
    if (solver_traits(name).is_direct || name == "auto") {
      std::vector<double> x(3);
      const SolveSummary summary = make_solver(solver_options(name, 1e-6))->solve(system, x);
      // As it is stored the matrix may have an inverse, of 1e16.
      EXPECT_TRUE(!summary.status.ok() || summary.relative_residual < 1e-2)
          << name << " leaves " << summary.relative_residual;
      EXPECT_EQ(summary.status.ok(), summary.status.message.empty()) << name;
    }
  }
}

}  // namespace
}  // namespace taut::test
