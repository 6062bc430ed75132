// PARDISO's CG on the factor of an earlier system: when it is used, when it falls back, and that the answer is right either way.

#include <gtest/gtest.h>

#include <limits>

#include "solve/constrained_case.h"
#include "taut/base/parallel.h"

namespace taut::test {
namespace {

// A change of the stiffness, D A D with a diagonal D between 1 and 1 + change: definite, and far from A when change is large.
void stiffen(Random& random, BlockCsr& a, double change) {
  std::vector<double> d(static_cast<std::size_t>(a.dofs()));
  for (double& value : d) value = 1.0 + change * random.uniform(0.0, 1.0);
  for_each_entry(a, [&](Index row, Index column, double& value) { value *= d[row] * d[column]; });
}

class PardisoCgsTest : public testing::Test {
 protected:
  SolveSummary solve(double change = 0.0) {
    if (change > 0.0) stiffen(random_, c_.a, change);
    x_.assign(c_.b.size(), 0.0);
    return solver_->solve(c_.system(), x_);
  }
  void expect_right() { EXPECT_LT(relative_difference(x_, c_.solution()), 1e-6); }
  static bool says(const SolveSummary& summary, const char* part) { return summary.remark.find(part) != std::string::npos; }

  Random random_{1};
  ConstrainedCase c_ = random_case(random_, {.nodes = 60, .margin = 1e-3});
  std::unique_ptr<ConstrainedSolver> solver_ = make_solver(solver_options("pardiso_cgs", 1e-9));
  std::vector<double> x_;
};

TEST_F(PardisoCgsTest, FactorisesFirstThenIterates) {
  const SolveSummary first = solve();
  EXPECT_TRUE(first.status.ok() && first.iterations == 0 && first.remark.empty()) << first.remark;
  EXPECT_GT(first.order_ms, 0.0);
  EXPECT_GT(first.factor_ms, 0.0);
  expect_right();
  int before = 0;
  for (const double change : {1e-6, 1e-3, 1e-1}) {
    const SolveSummary next = solve(change);
    EXPECT_TRUE(next.status.ok() && !next.fell_back && next.remark.empty()) << next.remark;
    EXPECT_EQ(next.factor_ms, 0.0);
    EXPECT_GE(next.iterations, std::max(1, before));
    before = next.iterations;
    expect_right();
  }
  EXPECT_GT(before, 2);
}

TEST_F(PardisoCgsTest, FallsBackWhenTheMatrixChangedMuch) {
  solve();
  EXPECT_FALSE(solve(1e-3).fell_back);
  const SolveSummary far = solve(1e4);
  EXPECT_TRUE(far.status.ok() && far.fell_back);
  EXPECT_TRUE(says(far, "gave up") && says(far, "fall-back 1 in 3 systems")) << far.remark;
  EXPECT_LT(far.relative_residual, 1e-11);  // that of a factorisation
  // The new factor is kept: a matrix near it takes few iterations.
  const SolveSummary near = solve(1e-6);
  EXPECT_TRUE(near.status.ok() && !near.fell_back) << near.remark;
  EXPECT_GT(near.iterations, 0);
  EXPECT_LE(near.iterations, 5);
  EXPECT_TRUE(says(solve(1e4), "fall-back 2 in 5 systems"));
}

TEST_F(PardisoCgsTest, OtherConstraintsNeedAnotherFactor) {
  solve();
  Index free = 0;
  while (c_.constraints.ndof(free) != 3) ++free;
  c_.fix(free);
  const SolveSummary other = solve();
  EXPECT_TRUE(other.status.ok() && other.iterations == 0 && says(other, "another pattern")) << other.remark;
  EXPECT_GT(other.factor_ms, 0.0);
  expect_right();
  EXPECT_GT(solve(1e-3).iterations, 0);
  expect_right();
}

TEST_F(PardisoCgsTest, ToleranceDecidesHowManyDigits) {
  int before = 0;
  double error_before = 1.0;
  for (const double tolerance : {1e-1, 1e-3, 1e-6, 1e-9}) {
    Random random(7);
    ConstrainedCase c = random_case(random, {.nodes = 60, .margin = 1e-3});
    const auto solver = make_solver(solver_options("pardiso_cgs", tolerance));
    std::vector<double> x(c.b.size());
    solver->solve(c.system(), x);
    stiffen(random, c.a, 0.5);
    const SolveSummary summary = solver->solve(c.system(), x);
    ASSERT_TRUE(summary.status.ok() && !summary.fell_back) << summary.remark;
    EXPECT_GT(summary.iterations, before);
    EXPECT_LT(summary.relative_residual, 0.2 * error_before);
    before = summary.iterations, error_before = summary.relative_residual;
  }
}

TEST_F(PardisoCgsTest, RefusesNaNAndIndefiniteThenRecovers) {
  solve();
  const BlockCsr good = c_.a;
  for_each_entry(c_.a, [](Index row, Index column, double& value) {
    if (row == column) value = std::numeric_limits<double>::quiet_NaN();
  });
  const SolveSummary poisoned = solve();
  EXPECT_EQ(poisoned.status.outcome, Outcome::not_positive_definite);
  c_.a = good;
  const SolveSummary mended = solve();
  EXPECT_TRUE(mended.status.ok() && mended.iterations == 0);
  expect_right();
  // CG notices that -A is not definite, and so does the factorisation it falls back to.
  for (double& value : c_.a.values) value = -value;
  const SolveSummary negative = solve();
  EXPECT_FALSE(negative.status.ok() && negative.relative_residual > 1e-6) << negative.relative_residual << ' ' << negative.remark;
  c_.a = good;
  EXPECT_TRUE(solve().status.ok());
  expect_right();
}

TEST(PardisoCgsDeterminism, SameBitsForAnyNumberOfThreads) {
  const int before = thread_count();
  std::vector<std::vector<double>> results;
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    Random random(3);
    ConstrainedCase c;
    constexpr Index nodes = 6000;
    c.a = random_spd(random, make_pattern(random_graph(random, nodes, 3, 12), 3));
    c.b = random.vector(3 * nodes), c.z = random.vector(3 * nodes);
    c.constraints.reset(nodes);
    const auto solver = make_solver(solver_options("pardiso_cgs", 1e-6));
    std::vector<double> x(c.b.size());
    solver->solve(c.system(), x);
    results.push_back(x);
    stiffen(random, c.a, 0.3);
    const SolveSummary summary = solver->solve(c.system(), x);
    EXPECT_GT(summary.iterations, 3);
    results.push_back(x);
  }
  set_thread_count(before);
  EXPECT_EQ(results[0], results[2]);
  EXPECT_EQ(results[1], results[3]);
}

}  // namespace
}  // namespace taut::test
