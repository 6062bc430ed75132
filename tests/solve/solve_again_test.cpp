// Another right-hand side, with the last factor where there is one.

#include <gtest/gtest.h>

#include "solve/constrained_case.h"

namespace taut::test {
namespace {

class SolveAgain : public testing::TestWithParam<std::string> {
 protected:
  SolverOptions options() const { return solver_options(GetParam(), 1e-10); }
  bool keeps_factor() const {
    for (const std::string backend : {"cholmod", "pardiso"})
      if (GetParam() == backend) return true;
    return GetParam() == "eigen_ldlt" || GetParam() == "block_cholesky" ||
           GetParam() == "cholmod_reused_analysis";
  }
  static void take_other_load(Random& random, ConstrainedCase& c) {
    c.b = random.vector(c.size()), c.z = random.vector(c.size());
    c.guess = random.vector(c.size());
  }
};

INSTANTIATE_TEST_SUITE_P(All, SolveAgain, testing::ValuesIn(solvers_to_test()),
                         [](const auto& solver) { return test_name(solver.param); });

TEST_P(SolveAgain, IsAFreshSolve) {
  Random random(1);
  for (const int only : {-1, 3, 0}) {
    ConstrainedCase c = random_case(random, {.nodes = 30, .only = only});
    const auto solver = make_solver(options());
    std::vector<double> x(c.b.size()), fresh(c.b.size());
    ASSERT_TRUE(solver->solve(c.system(), x).status.ok());
    for (int load = 0; load < 3; ++load) {
      take_other_load(random, c);
      const SolveSummary summary = solver->solve_again(c.system(), x);
      EXPECT_TRUE(summary.status.ok()) << summary.status.message;
      EXPECT_LT(relative_difference(x, c.solution()), 1e-7);
      if (!keeps_factor()) continue;
      make_solver(options())->solve(c.system(), fresh);
      EXPECT_LT(relative_difference(x, as_eigen(fresh)), 1e-14);
    }
  }
}

// Without constraints, and before there was a first.
TEST_P(SolveAgain, IsASolveWhereThereWasNone) {
  Random random(2);
  const BlockCsr a = random_spd(random, make_pattern(random_graph(random, 40, 3, 15), 3));
  const auto solver = make_solver(options());
  for (int load = 0; load < 2; ++load) {
    const std::vector<double> b = random.vector(a.dofs());
    std::vector<double> x(b.size());
    LinearSystem system;
    system.matrix = &a, system.rhs = b;
    const SolveSummary summary = solver->solve_again(system, x);
    EXPECT_TRUE(summary.status.ok()) << summary.status.message;
    EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), 1e-7);
  }
}

// A factor that is kept is the one of the matrix as it was, and the residual tells.
TEST_P(SolveAgain, TellsOfAMatrixThatIsAnother) {
  Random random(3);
  ConstrainedCase c = random_case(random, {.nodes = 30});
  const auto solver = make_solver(options());
  std::vector<double> x(c.b.size());
  solver->solve(c.system(), x);
  const double change = 1e-4;
  for (double& value : c.a.values) value *= 1.0 + change;
  const SolveSummary summary = solver->solve_again(c.system(), x);
  EXPECT_TRUE(summary.status.ok()) << summary.status.message;
  if (keeps_factor()) {
    EXPECT_GT(summary.relative_residual, 0.1 * change * change);
  } else {
    EXPECT_LT(relative_difference(x, c.solution()), 1e-7);
  }
  for (double& value : c.a.values) value *= 2.0;
  EXPECT_EQ(solver->solve_again(c.system(), x).status.ok(), !keeps_factor());
  // Which makes the next one a fresh one.
  EXPECT_TRUE(solver->solve_again(c.system(), x).status.ok());
  EXPECT_LT(relative_difference(x, c.solution()), 1e-7);
}

TEST_P(SolveAgain, UsesNoFactorFromBeforeAFailure) {
  Random random(4);
  ConstrainedCase c = random_case(random, {.nodes = 20, .only = 3});
  const auto solver = make_solver(options());
  std::vector<double> x(c.b.size());
  ASSERT_TRUE(solver->solve(c.system(), x).status.ok());
  for (double& value : c.a.values) value = -value;
  EXPECT_FALSE(solver->solve(c.system(), x).status.ok());
  EXPECT_FALSE(solver->solve_again(c.system(), x).status.ok());
  // Nor where a right-hand side was refused before the matrix was looked at.
  for (double& value : c.a.values) value = -value;
  ASSERT_TRUE(solver->solve(c.system(), x).status.ok());
  for (double& value : c.a.values) value *= 3.0;
  const double good = std::exchange(c.b[5], std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(solver->solve(c.system(), x).status.ok());
  c.b[5] = good;
  EXPECT_TRUE(solver->solve_again(c.system(), x).status.ok());
  EXPECT_LT(relative_difference(x, c.solution()), 1e-7);
}

}  // namespace
}  // namespace taut::test
