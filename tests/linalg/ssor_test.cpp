#include "taut/linalg/ssor.h"

#include <gtest/gtest.h>

#include <limits>

#include "linalg/incomplete_factors.h"

namespace taut::test {
namespace {

TEST(Ssor, IsTheDenseFormula) {
  Random random(1);
  for (const Index dim : {3, 1, 0, 0})
    for (const double omega : {1.0, 1.4, 0.6}) {
      const BlockCsr a =
          random_spd(random, pattern_of(random, random_graph(random, 50, 3, 15), dim));
      const BlockPattern& p = *a.pattern;
      const Eigen::MatrixXd full = dense(a);
      Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(a.dofs(), a.dofs()), d = lower;
      for (Index i = 0; i < p.rows(); ++i) {
        const Index at = p.dof_start[i], size = p.dim(i);
        d.block(at, at, size, size) = full.block(at, at, size, size);
        lower.block(at, 0, size, at) = full.block(at, 0, size, at);
      }
      const Eigen::MatrixXd left = d / omega + lower,
                            m = omega / (2.0 - omega) * left * d.inverse() * left.transpose();
      BlockSsor ssor(omega);
      ASSERT_TRUE(ssor.update(a).ok());
      const std::vector<double> r = random.vector(a.dofs());
      std::vector<double> z(r.size());
      ssor.apply(r, z);
      EXPECT_LT(relative_difference(z, m.llt().solve(as_eigen(r))), 1e-12) << dim << " " << omega;
      const Eigen::MatrixXd inverse = dense_inverse(ssor, a.dofs());
      EXPECT_LT((inverse - inverse.transpose()).norm(), 1e-13 * inverse.norm());
    }
}

// On a block diagonal matrix symmetric Gauss-Seidel is the inverse.
TEST(Ssor, IsExactWithoutCoupling) {
  Random random(2);
  const BlockCsr a = random_spd(
      random, make_pattern(std::vector<std::vector<Index>>(10), random_dims(random, 10)));
  BlockSsor ssor;
  ASSERT_TRUE(ssor.update(a).ok());
  EXPECT_LT((dense_inverse(ssor, a.dofs()) - dense(a).inverse()).norm(), 1e-12);
}

TEST(Ssor, ReportsWhereTheMatrixIsNotPositive) {
  Random random(3);
  const BlockCsr good = random_spd(random, make_pattern(random_graph(random, 20, 2, 10), 3));
  for (const double bad : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    BlockCsr a = good;
    a.block(7, a.pattern->diagonal[7])[a.pattern->width(7) + 1] = bad;
    BlockSsor ssor;
    const Status status = ssor.update(a);
    EXPECT_EQ(status.outcome,
              std::isfinite(bad) ? Outcome::not_positive_definite : Outcome::not_finite);
    EXPECT_NE(status.message.find("node 7"), std::string::npos) << status.message;
  }
}

}  // namespace
}  // namespace taut::test
