// core_fast takes core_pcg's steps, whatever the constraints; it goes to double precision by itself, and says so.

#include <gtest/gtest.h>

#include "solve/constrained_case.h"

namespace taut::test {
namespace {

TEST(CoreFast, TakesTheStepsOfCorePcg) {
  Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    CaseOptions options;
    options.nodes = 60;
    const ConstrainedCase c = random_case(random, options);
    std::vector<double> x(c.b.size()), expected(c.b.size());
    const SolveSummary slow = make_solver(solver_options("core_pcg:eigen", 1e-4))->solve(c.system(), expected);
    const SolveSummary fast = make_solver(solver_options("core_fast", 1e-4))->solve(c.system(), x);
    ASSERT_TRUE(fast.status.ok()) << fast.status.message;
    EXPECT_EQ(fast.iterations, slow.iterations);
    EXPECT_NEAR(fast.start_value, slow.start_value, 1e-5 * slow.start_value);
    EXPECT_NEAR(fast.stop_value, slow.stop_value, 1e-2 * slow.stop_value);
    EXPECT_LT(relative_difference(x, as_eigen(expected)), 1e-5);
    EXPECT_STREQ(fast.precision, "single");
    EXPECT_EQ(fast.fallbacks, 0);
  }
}

// One object, one matrix pattern, contacts that come and go.
TEST(CoreFast, KeepsItsAnalysisWhileConstraintsChange) {
  Random random(2);
  for (const std::string name : {"core_fast", "block_cholesky"}) {
    const auto solver = make_solver(solver_options(name, 1e-10));
    ConstrainedCase first = random_case(random, {});
    for (int trial = 0; trial < 8; ++trial) {
      ConstrainedCase c = random_case(random, {});
      c.a = BlockCsr(first.a.pattern);
      c.a.values = random_spd(random, first.a.pattern).values;
      c.core.clear();
      for (Index i = 0; i < c.a.rows(); ++i)
        for (Index k = c.a.pattern->row_start[i]; k < c.a.pattern->row_start[i + 1]; ++k)
          c.core.push_back(std::abs(c.a.pattern->column[k] - i) <= 1);
      std::vector<double> x(c.b.size());
      const SolveSummary summary = solver->solve(c.system(), x);
      ASSERT_TRUE(summary.status.ok()) << summary.status.message;
      EXPECT_LT(relative_difference(x, c.solution()), 1e-8) << name;
    }
  }
}

TEST(CoreFast, FallsBackToDoubleWhenSingleOverflows) {
  Random random(3);
  ConstrainedCase c = random_case(random, {});
  const Eigen::VectorXd expected = c.solution();
  for (auto* values : {&c.a.values, &c.b})
    for (double& value : *values) value *= 1e100;
  std::vector<double> x(c.b.size());
  const SolveSummary summary = make_solver(solver_options("core_fast", 1e-8))->solve(c.system(), x);
  ASSERT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_STREQ(summary.precision, "double");
  EXPECT_EQ(summary.fallbacks, 1);
  EXPECT_FALSE(summary.remark.empty());
  EXPECT_LT(relative_difference(x, expected), 1e-6);
}

// Many stiff chains whose rigid motions only the masses hold: rounded to single precision the core loses these masses, so that a pivot
// fails or each chain's rigid motion gets an energy of its own, by chance.
TEST(CoreFast, FallsBackToDoubleWhereSinglePrecisionLosesTheMasses) {
  Random random(4);
  constexpr Index nodes = 400, length = 5;
  ConstrainedCase c;
  std::vector<std::vector<Index>> links(nodes);
  for (Index i = 0; i + 1 < nodes; ++i)
    if (i % length != length - 1) links[i].push_back(i + 1), links[i + 1].push_back(i);
  c.a = BlockCsr(make_pattern(links, 3));
  for_each_entry(c.a, [&](Index row, Index column, double& value) {
    const Index i = row / 3;
    const double stiffness = 1e9 * (1.0 + 0.37 * (i / length));
    if (row == column) value = 1.0 + stiffness * (i % length == 0 || i % length == length - 1 ? 1.0 : 2.0);
    if (row != column && row % 3 == column % 3) value = -stiffness;
  });
  c.b = random.vector(3 * nodes), c.z.assign(c.b.size(), 0.0);
  c.constraints.reset(nodes);
  c.core.assign(static_cast<std::size_t>(c.a.pattern->blocks()), 1);
  std::vector<double> x(c.b.size());
  const SolveSummary summary = make_solver(solver_options("core_fast", 1e-6))->solve(c.system(), x);
  ASSERT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_LT(summary.stop_value, 1e-6);
  EXPECT_EQ(summary.fallbacks, 1);
  EXPECT_STREQ(summary.precision, "double");
  EXPECT_LT(summary.iterations, 30);
}

TEST(CoreFast, NothingToDo) {
  Random random(5);
  ConstrainedCase c = random_case(random, {.only = 0});
  std::vector<double> x(c.b.size());
  const SolveSummary summary = make_solver(solver_options("core_fast", 1e-6))->solve(c.system(), x);
  EXPECT_TRUE(summary.status.ok());
  EXPECT_EQ(summary.iterations, 0);
  EXPECT_EQ(x, c.z);
}

TEST(CoreFast, AnIndefiniteMatrixIsReported) {
  Random random(6);
  ConstrainedCase c = random_case(random, {.only = 3});
  for (double& value : c.a.values) value = -value;
  std::vector<double> x(c.b.size());
  const SolveSummary summary = make_solver(solver_options("core_fast", 1e-6))->solve(c.system(), x);
  EXPECT_EQ(summary.status.outcome, Outcome::not_positive_definite);
  EXPECT_EQ(summary.fallbacks, 1);
}

}  // namespace
}  // namespace taut::test
