#include "taut/linalg/preconditioner.h"

#include <gtest/gtest.h>

#include <limits>

#include "linalg/random_matrix.h"

namespace taut::test {
namespace {

BlockCsr mixed_spd(Random& random) {
  const auto dims = random_dims(random, 80);
  return random_spd(random, make_pattern(random_graph(random, 80, 4, 30), dims));
}

std::vector<double> applied(const Preconditioner& m, const std::vector<double>& r) {
  std::vector<double> z(r.size(), 1e300);
  m.apply(r, z);
  return z;
}

TEST(DiagonalPreconditioner, DividesByTheDiagonal) {
  Random random(1);
  const BlockCsr a = mixed_spd(random);
  DiagonalPreconditioner m;
  ASSERT_TRUE(m.update(a).ok());
  const std::vector<double> r = random.vector(a.dofs());
  EXPECT_LT(relative_difference(applied(m, r), as_eigen(r).cwiseQuotient(dense(a).diagonal())),
            1e-15);
}

TEST(BlockDiagonalPreconditioner, InvertsTheDiagonalBlocks) {
  Random random(2);
  for (int trial = 0; trial < 3; ++trial) {
    const BlockCsr a = mixed_spd(random);
    const BlockPattern& p = *a.pattern;
    const Eigen::MatrixXd d = dense(a);
    Eigen::MatrixXd blocks = Eigen::MatrixXd::Zero(a.dofs(), a.dofs());
    for (Index i = 0; i < p.rows(); ++i)
      blocks.block(p.dof_start[i], p.dof_start[i], p.dim(i), p.dim(i)) =
          d.block(p.dof_start[i], p.dof_start[i], p.dim(i), p.dim(i));
    BlockDiagonalPreconditioner m;
    ASSERT_TRUE(m.update(a).ok());
    const std::vector<double> r = random.vector(a.dofs());
    EXPECT_LT(relative_difference(applied(m, r), blocks.llt().solve(as_eigen(r))), 1e-13);
  }
}

TEST(Preconditioner, OutlivesItsMatrix) {
  Random random(3);
  DiagonalPreconditioner diagonal;
  BlockDiagonalPreconditioner block;
  std::vector<double> r, z_diagonal, z_block;
  {
    const BlockCsr a = mixed_spd(random);
    r = random.vector(a.dofs());
    ASSERT_TRUE(diagonal.update(a).ok() && block.update(a).ok());
    z_diagonal = applied(diagonal, r), z_block = applied(block, r);
  }
  EXPECT_EQ(applied(diagonal, r), z_diagonal);
  EXPECT_EQ(applied(block, r), z_block);
}

TEST(Preconditioner, ReportsWhereTheMatrixIsNotPositive) {
  Random random(4);
  const BlockCsr good = random_spd(random, make_pattern(random_graph(random, 20, 2, 10), 3));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, 0.0, nan, HUGE_VAL}) {
    BlockCsr a = good;
    a.block(7, a.pattern->diagonal[7])[a.pattern->width(7) + 1] = bad;  // node 7, unknown 22
    DiagonalPreconditioner diagonal;
    const Status scalar = diagonal.update(a);
    EXPECT_EQ(scalar.outcome,
              std::isfinite(bad) ? Outcome::not_positive_definite : Outcome::not_finite);
    EXPECT_NE(scalar.message.find("22"), std::string::npos) << scalar.message;
    BlockDiagonalPreconditioner block;
    const Status status = block.update(a);
    EXPECT_EQ(status.outcome,
              std::isfinite(bad) ? Outcome::not_positive_definite : Outcome::not_finite)
        << bad;
    EXPECT_NE(status.message.find("node 7"), std::string::npos) << status.message;
  }
}

// Positive diagonal, but a negative eigenvalue: only the block one can see it.
TEST(Preconditioner, BlocksSeeWhatTheDiagonalCannot) {
  BlockCsr a(make_pattern({{0}}, 2));
  a.values = {1.0, 2.0, 2.0, 1.0};
  DiagonalPreconditioner diagonal;
  BlockDiagonalPreconditioner block;
  EXPECT_TRUE(diagonal.update(a).ok());
  EXPECT_EQ(block.update(a).outcome, Outcome::not_positive_definite);
}

}  // namespace
}  // namespace taut::test
