#include "taut/linalg/pcg.h"

#include <gtest/gtest.h>

#include <limits>

#include "linalg/random_matrix.h"
#include "taut/linalg/sparse_cholesky.h"

namespace taut::test {
namespace {

struct LiteralRun {
  std::vector<Eigen::VectorXd> iterates;
  double start = 0.0, stop = 0.0;
};

// uPCG line by line as the paper prints it (Section 2), with dense matrices.
LiteralRun paper_upcg(const Eigen::MatrixXd& a, const Eigen::MatrixXd& mp_inverse,
                      const Eigen::VectorXd& b, Eigen::VectorXd dv, double tol) {
  LiteralRun run;
  const double delta0 = b.transpose() * mp_inverse * b;
  Eigen::VectorXd r = b - a * dv;
  Eigen::VectorXd c = mp_inverse * r;
  double delta = r.dot(c);
  run.start = std::sqrt(delta / delta0);
  while (delta > tol * tol * delta0) {
    const Eigen::VectorXd q = a * c;
    const double alpha = delta / c.dot(q);
    dv += alpha * c;
    r -= alpha * q;
    const Eigen::VectorXd s = mp_inverse * r;
    const double delta_old = delta;
    delta = r.dot(s);
    c = s + (delta / delta_old) * c;
    run.iterates.push_back(dv);
  }
  run.stop = std::sqrt(delta / delta0);
  return run;
}

Eigen::MatrixXd inverse_of(const Preconditioner& m, Index n) {
  Eigen::MatrixXd inverse(n, n);
  std::vector<double> unit(static_cast<std::size_t>(n), 0.0), column(unit);
  for (Index j = 0; j < n; ++j) {
    unit[j] = 1.0;
    m.apply(unit, column);
    unit[j] = 0.0;
    inverse.col(j) = as_eigen(column);
  }
  return inverse;
}

BlockCsr mixed_spd(Random& random, double margin) {
  const auto dims = random_dims(random, 70);
  return random_spd(random, make_pattern(random_graph(random, 70, 3, 20), dims), margin);
}

void compare_with_paper(const BlockCsr& a, Preconditioner& m, Random& random, double tolerance) {
  ASSERT_TRUE(m.update(a).ok());
  const Index n = a.dofs();
  const std::vector<double> b = random.vector(n), guess = random.vector(n);
  const LiteralRun literal =
      paper_upcg(dense(a), inverse_of(m, n), as_eigen(b), as_eigen(guess), tolerance);

  std::vector<double> x = guess;
  KrylovOptions options{tolerance, 1000, {}};
  int calls = 0;
  double last_value = 0.0;
  options.observer = [&](int iteration, double value, std::span<const double> iterate) {
    ASSERT_EQ(iteration, ++calls);
    ASSERT_LE(static_cast<std::size_t>(calls), literal.iterates.size());
    EXPECT_LT(relative_difference(iterate, literal.iterates[static_cast<std::size_t>(calls) - 1]),
              1e-8)
        << iteration;
    last_value = value;
  };
  const KrylovResult result = pcg(BlockCsrOperator(a), m, b, x, options);
  EXPECT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_EQ(result.iterations, static_cast<int>(literal.iterates.size()));
  EXPECT_EQ(calls, result.iterations);
  EXPECT_EQ(last_value, result.stop_value);
  EXPECT_NEAR(result.start_value, literal.start, 1e-10 * literal.start);
  EXPECT_NEAR(result.stop_value, literal.stop, 1e-4 * literal.stop);
  EXPECT_LE(result.stop_value, tolerance);
}

TEST(Pcg, IterationByIterationAsThePaperWritesIt) {
  Random random(1);
  for (const double tolerance : {1e-3, 1e-8})
    for (int trial = 0; trial < 3; ++trial) {
      const BlockCsr a = mixed_spd(random, 0.01);
      DiagonalPreconditioner diagonal;
      compare_with_paper(a, diagonal, random, tolerance);
      BlockDiagonalPreconditioner block;
      compare_with_paper(a, block, random, tolerance);
    }
}

TEST(Pcg, SolvesAgainstDenseCholesky) {
  Random random(2);
  for (int trial = 0; trial < 5; ++trial) {
    const BlockCsr a = mixed_spd(random, 1e-3);
    const std::vector<double> b = random.vector(a.dofs());
    std::vector<double> x(b.size(), 0.0);
    BlockDiagonalPreconditioner m;
    ASSERT_TRUE(m.update(a).ok());
    const KrylovResult result = pcg(BlockCsrOperator(a), m, b, x, {1e-12, 1000, {}});
    EXPECT_TRUE(result.status.ok());
    EXPECT_EQ(result.start_value, 1.0);  // of the zero guess, by definition of δ0
    EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), 1e-10);
  }
}

struct SmallCase {
  BlockCsr a;
  DiagonalPreconditioner m;
  std::vector<double> b, x;
};

SmallCase small_case() {
  Random random(3);
  SmallCase c;
  c.a = random_spd(random, make_pattern(random_graph(random, 30, 3, 20), 3), 1e-3);
  EXPECT_TRUE(c.m.update(c.a).ok());
  c.b = random.vector(90), c.x = random.vector(90);
  return c;
}

TEST(Pcg, NoRightHandSideMeansNoSolution) {
  SmallCase c = small_case();
  c.b.assign(90, 0.0);
  const KrylovResult result = pcg(BlockCsrOperator(c.a), c.m, c.b, c.x, {});
  EXPECT_TRUE(result.status.ok());
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(c.x, std::vector<double>(90, 0.0));
}

TEST(Pcg, GoodGuessNeedsNoIteration) {
  SmallCase c = small_case();
  const Eigen::VectorXd solution = dense(c.a).llt().solve(as_eigen(c.b));
  c.x.assign(solution.begin(), solution.end());
  const KrylovResult result = pcg(BlockCsrOperator(c.a), c.m, c.b, c.x, {1e-6, 10, {}});
  EXPECT_TRUE(result.status.ok());
  EXPECT_EQ(result.iterations, 0);
  EXPECT_LT(result.start_value, 1e-12);
}

TEST(Pcg, ReportsTheLimit) {
  SmallCase c = small_case();
  const KrylovResult result = pcg(BlockCsrOperator(c.a), c.m, c.b, c.x, {1e-12, 3, {}});
  EXPECT_EQ(result.status.outcome, Outcome::max_iterations);
  EXPECT_EQ(result.iterations, 3);
  EXPECT_GT(result.stop_value, 1e-12);
  EXPECT_FALSE(result.status.message.empty());
}

TEST(Pcg, ReportsAnIndefiniteMatrix) {
  SmallCase c = small_case();
  // The preconditioner is that of the good matrix: only the curvature of a search direction can
  // tell.
  for_each_entry(c.a, [](Index row, Index column, double& value) {
    if (row == column && row < 3) value = -value;
  });
  const KrylovResult result = pcg(BlockCsrOperator(c.a), c.m, c.b, c.x, {1e-12, 1000, {}});
  EXPECT_EQ(result.status.outcome, Outcome::not_positive_definite)
      << name_of(result.status.outcome);
}

TEST(Pcg, ReportsAnIndefinitePreconditioner) {
  struct Negative : Preconditioner {
    Status update(const BlockCsr&) override { return {}; }
    void apply(std::span<const double> r, std::span<double> z) const override {
      for (std::size_t i = 0; i < r.size(); ++i) z[i] = -r[i];
    }
  };
  SmallCase c = small_case();
  const KrylovResult result = pcg(BlockCsrOperator(c.a), Negative{}, c.b, c.x, {});
  EXPECT_EQ(result.status.outcome, Outcome::not_positive_definite);
  EXPECT_NE(result.status.message.find("preconditioner"), std::string::npos);
}

TEST(Pcg, ReportsWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int where = 0; where < 4; ++where) {
    SmallCase c = small_case();
    if (where == 0) c.b[5] = nan;
    if (where == 1) c.x[5] = nan;
    if (where == 2) c.a.values[50] = nan;
    if (where == 3) c.a.values[50] = HUGE_VAL;
    const KrylovResult result = pcg(BlockCsrOperator(c.a), c.m, c.b, c.x, {1e-8, 1000, {}});
    EXPECT_EQ(result.status.outcome, Outcome::not_finite) << where << ' ' << result.status.message;
    EXPECT_LE(result.iterations, 1);
  }
}

}  // namespace
}  // namespace taut::test
