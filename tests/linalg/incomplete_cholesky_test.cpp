#include "taut/linalg/incomplete_cholesky.h"

#include <gtest/gtest.h>

#include <limits>

#include "linalg/incomplete_factors.h"
#include "taut/linalg/pcg.h"

namespace taut::test {
namespace {

// The block-wise Cholesky factor of M, for the second half of what defines IC(0): no blocks outside
// A's pattern.
double fill_outside_pattern(const Eigen::MatrixXd& m, const BlockPattern& p) {
  const Eigen::MatrixXd l = m.llt().matrixL();
  double largest = 0.0;
  for (Index i = 0; i < p.rows(); ++i)
    for (Index j = 0; j < i; ++j)
      if (p.find(i, j) < 0 && p.dim(i) > 0 && p.dim(j) > 0)
        largest = std::max(
            largest,
            l.block(p.dof_start[i], p.dof_start[j], p.dim(i), p.dim(j)).cwiseAbs().maxCoeff());
  return largest;
}

TEST(IncompleteCholesky, IsAOnItsPatternAndFillsNothingElse) {
  Random random(1);
  for (const Index dim : {3, 1, 0, 0, 0}) {
    const BlockCsr a = random_spd(random, pattern_of(random, random_graph(random, 60, 3, 20), dim));
    BlockIncompleteCholesky ic;
    ASSERT_TRUE(ic.update(a).ok());
    EXPECT_EQ(ic.shift(), 0.0);
    EXPECT_EQ(ic.remark(), "");
    const Eigen::MatrixXd inverse = dense_inverse(ic, a.dofs()), m = inverse.inverse();
    EXPECT_LT((inverse - inverse.transpose()).norm(), 1e-13 * inverse.norm());
    EXPECT_GT(inverse.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
    EXPECT_LT(difference_on_pattern(m, a), 1e-10 * m.norm());
    EXPECT_LT(fill_outside_pattern(m, *a.pattern), 1e-10 * m.norm());
    EXPECT_GT((m - dense(a)).norm(), 1e-3 * m.norm());  // there was fill to drop
  }
}

TEST(IncompleteCholesky, IsExactWithoutFill) {
  Random random(2);
  for (const Index dim : {3, 1, 0}) {
    const BlockCsr a = random_spd(random, pattern_of(random, chain(200), dim), 1e-3);
    BlockIncompleteCholesky ic;
    ASSERT_TRUE(ic.update(a).ok());
    const std::vector<double> b = random.vector(a.dofs());
    std::vector<double> x(b.size());
    ic.apply(b, x);
    EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), 1e-10);
    std::fill(x.begin(), x.end(), 0.0);
    EXPECT_EQ(pcg(BlockCsrOperator(a), ic, b, x, {1e-8, 10, {}}).iterations, 1);
  }
}

// A change of basis at the nodes is one of M.
TEST(IncompleteCholesky, DoesNotDependOnTheAxes) {
  Random random(3);
  const auto pattern = make_pattern(random_graph(random, 40, 3, 12), 3);
  const BlockCsr a = random_spd(random, pattern);
  Eigen::MatrixXd rotation = Eigen::MatrixXd::Zero(a.dofs(), a.dofs());
  for (Index i = 0; i < a.rows(); ++i)
    rotation.block<3, 3>(3 * i, 3 * i) =
        Eigen::AngleAxisd(random.uniform(-3.0, 3.0), random.direction()).toRotationMatrix();
  const Eigen::MatrixXd rotated = rotation.transpose() * dense(a) * rotation;
  BlockCsr b(pattern);
  for_each_entry(b, [&](Index row, Index column, double& value) { value = rotated(row, column); });
  BlockIncompleteCholesky of_a, of_b;
  ASSERT_TRUE(of_a.update(a).ok() && of_b.update(b).ok());
  const Eigen::MatrixXd expected = rotation.transpose() * dense_inverse(of_a, a.dofs()) * rotation;
  EXPECT_LT((dense_inverse(of_b, a.dofs()) - expected).norm(), 1e-12 * expected.norm());
}

// Kershaw 1978: positive definite, but the last pivot of its IC(0) is negative. A ring of four, as
// scalars and as blocks.
BlockCsr kershaw(Index dim) {
  BlockCsr a(make_pattern({{1, 3}, {0, 2}, {1, 3}, {0, 2}}, dim));
  for_each_entry(a, [&](Index row, Index column, double& value) {
    const Index i = row / dim, j = column / dim;
    if (row % dim == column % dim) value = i == j ? 3.0 : std::abs(i - j) == 3 ? 2.0 : -2.0;
  });
  return a;
}

TEST(IncompleteCholesky, FindsAShiftForKershawsMatrix) {
  for (const Index dim : {1, 2, 3}) {
    const BlockCsr a = kershaw(dim);
    ASSERT_GT(dense(a).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.1);
    BlockIncompleteCholesky ic;
    ASSERT_TRUE(ic.update(a).ok());
    // By hand, with d = 3 (1 + α): pivots d, d - 4/d, d - 4/(d - 4/d), and the last is
    // d - 4/d - 4/(d - 4/(d - 4/d)), whose largest zero is where the least shift lies.
    const auto last_pivot = [](double shift) {
      const double d = 3.0 * (1.0 + shift), second = d - 4.0 / d, third = d - 4.0 / second;
      return d - 4.0 / d - 4.0 / third;
    };
    EXPECT_LT(last_pivot(0.0), 0.0);
    EXPECT_GT(last_pivot(ic.shift()), 0.0);
    // three halvings of a factor of two
    EXPECT_LT(last_pivot(ic.shift() / std::pow(2.0, 1.0 / 8.0) * 0.999), 0.0);
    EXPECT_GT(ic.factorizations(), 4);
    EXPECT_NE(ic.remark().find("node 3"), std::string::npos) << ic.remark();

    BlockCsr shifted = a;
    for_each_entry(shifted, [&](Index row, Index column, double& value) {
      if (row == column) value *= 1.0 + ic.shift();
    });
    const Eigen::MatrixXd m = dense_inverse(ic, a.dofs()).inverse();
    EXPECT_LT(difference_on_pattern(m, shifted), 1e-9);
    const std::vector<double> b = Random(4).vector(a.dofs());
    std::vector<double> x(b.size(), 0.0);
    EXPECT_TRUE(pcg(BlockCsrOperator(a), ic, b, x, {1e-12, 20, {}}).status.ok());
    EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), 1e-10);
  }
}

TEST(IncompleteCholesky, ForgetsTheShift) {
  BlockIncompleteCholesky ic, fresh;
  ASSERT_TRUE(ic.update(kershaw(3)).ok());
  Random random(5);
  const BlockCsr a = random_spd(random, make_pattern(random_graph(random, 30, 3, 9), 3));
  ASSERT_TRUE(ic.update(a).ok() && fresh.update(a).ok());
  EXPECT_EQ(ic.shift(), 0.0);
  EXPECT_EQ(ic.remark(), "");
  EXPECT_EQ(dense_inverse(ic, a.dofs()), dense_inverse(fresh, a.dofs()));
}

TEST(IncompleteCholesky, RefusesWhatNoShiftMends) {
  Random random(6);
  const BlockCsr good = random_spd(random, make_pattern(random_graph(random, 20, 2, 10), 3));
  for (const double bad : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    BlockCsr a = good;
    a.block(7, a.pattern->diagonal[7])[a.pattern->width(7) + 1] = bad;
    BlockIncompleteCholesky ic;
    const Status status = ic.update(a);
    EXPECT_EQ(status.outcome,
              std::isfinite(bad) ? Outcome::not_positive_definite : Outcome::not_finite)
        << bad;
    EXPECT_FALSE(status.message.empty());
  }
  BlockCsr a = good;
  *a.block(7, a.pattern->row_start[7]) = std::numeric_limits<double>::quiet_NaN();
  BlockIncompleteCholesky ic;
  EXPECT_EQ(ic.update(a).outcome, Outcome::not_finite);
}

TEST(IncompleteCholesky, OneNodeAndNone) {
  Random random(7);
  BlockCsr one(make_pattern({{0}}, 3));
  one.values = {4.0, 1.0, 0.0, 1.0, 3.0, 1.0, 0.0, 1.0, 2.0};
  BlockIncompleteCholesky ic;
  ASSERT_TRUE(ic.update(one).ok());
  EXPECT_LT((dense_inverse(ic, 3) - dense(one).inverse()).norm(), 1e-15);
  const std::vector<Index> held{0, 0, 0};
  const BlockCsr none(make_pattern(chain(3), held));
  ASSERT_TRUE(ic.update(none).ok());
  ic.apply({}, {});
}

}  // namespace
}  // namespace taut::test
