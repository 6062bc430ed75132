// What takes over where a solve fails (solve/fallback.h).

#include "taut/solve/fallback.h"

#include <gtest/gtest.h>

#include "solve/constrained_case.h"

namespace taut::test {
namespace {

ConstrainedCase stiff_case() {
  Random random(1);
  return random_case(random, {.nodes = 60, .margin = 1e-3});
}

// Positive definite blocks on the diagonal, and between them too much.
ConstrainedCase indefinite_case() {
  Random random(1);
  ConstrainedCase c = random_case(random, {.nodes = 20});
  for_each_entry(c.a, [](Index row, Index column, double& value) {
    if (row / 3 != column / 3) value *= 8.0;
  });
  return c;
}

TEST(Fallback, IsNotAskedWhereTheFirstSucceeds) {
  const ConstrainedCase c = stiff_case();
  const auto first = make_solver(solver_options("upcg:ic0", 1e-8));
  std::vector<double> x(c.b.size());
  int solves = 0;
  const SolveSummary summary = FallbackChain({}).solve(*first, [&](ConstrainedSolver& solver) {
    ++solves;
    return solver.solve(c.system(), x);
  });
  EXPECT_EQ(solves, 1);
  EXPECT_EQ(summary.solver, "upcg:ic0");
  EXPECT_EQ(summary.fallbacks, 0);
}

TEST(Fallback, TakesTheFirstOfTheChainThatSucceeds) {
  const ConstrainedCase c = stiff_case();
  SolverOptions options = solver_options("mpcg", 1e-8);
  options.max_iterations = 2;
  const auto first = make_solver(options);
  FallbackChain chain(options);
  for (int step = 1; step <= 2; ++step) {  // the second with the solvers that it has
    std::vector<double> x(c.b.size());
    const SolveSummary summary = chain.solve(*first, c.system(), x);
    EXPECT_TRUE(summary.status.ok()) << summary.status.message;
    EXPECT_EQ(summary.solver, "block_cholesky");
    EXPECT_EQ(summary.fallbacks, 1);
    EXPECT_LT(relative_difference(x, c.solution()), 1e-9);
  }
}

TEST(Fallback, LeavesOutWhatIsNotThereOrHasJustFailed) {
  const ConstrainedCase c = stiff_case();
  SolverOptions options = solver_options("upcg", 1e-8);
  options.max_iterations = 2;
  const char* const names[] = {"nobody", "upcg", "mpcg", "eigen_ldlt", "block_cholesky"};
  std::vector<double> x(c.b.size());
  const SolveSummary summary =
      FallbackChain(options, names).solve(*make_solver(options), c.system(), x);
  EXPECT_EQ(summary.solver, "eigen_ldlt");
  EXPECT_EQ(summary.fallbacks, 2);  // mpcg and this one
  EXPECT_LT(relative_difference(x, c.solution()), 1e-9);
}

TEST(Fallback, NamesAllThatFailed) {
  const ConstrainedCase c = indefinite_case();
  std::vector<double> x(c.b.size());
  const auto message_after = [&](const std::string& name) {
    const SolveSummary summary =
        FallbackChain({}).solve(*make_solver(solver_options(name, 1e-6)), c.system(), x);
    EXPECT_EQ(summary.status.outcome, Outcome::not_positive_definite);
    EXPECT_EQ(summary.solver, "eigen_ldlt");
    EXPECT_EQ(summary.fallbacks, name == "upcg" ? 2 : 1);
    EXPECT_TRUE(as_eigen(x).allFinite());
    return summary.status.message;
  };
  const std::string all = message_after("upcg");
  const std::size_t first = all.find("upcg: "), second = all.find("; then block_cholesky: "),
                    third = all.find("; then eigen_ldlt: ");
  EXPECT_TRUE(first == 0 && first < second && second < third && third != std::string::npos) << all;
  EXPECT_EQ(message_after("block_cholesky").find("then block_cholesky"), std::string::npos);
}

TEST(Fallback, WithoutAChainTheFirstIsTheLast) {
  const ConstrainedCase c = indefinite_case();
  std::vector<double> x(c.b.size());
  const auto first = make_solver(solver_options("upcg", 1e-6));
  const std::string alone = first->solve(c.system(), x).status.message;
  const SolveSummary summary = FallbackChain({}, {}).solve(*first, c.system(), x);
  EXPECT_EQ(summary.status.message, alone);
  EXPECT_EQ(summary.fallbacks, 0);
}

}  // namespace
}  // namespace taut::test
