#include "taut/linalg/incomplete_lu.h"

#include <gtest/gtest.h>

#include <limits>

#include "linalg/incomplete_factors.h"
#include "taut/linalg/bicgstab.h"
#include "taut/linalg/incomplete_cholesky.h"
#include "taut/linalg/pcg.h"

namespace taut::test {
namespace {

// Diagonally dominant, not symmetric.
BlockCsr random_nonsymmetric(Random& random, std::shared_ptr<const BlockPattern> pattern) {
  BlockCsr a = random_matrix(random, std::move(pattern));
  std::vector<double> row_sum(static_cast<std::size_t>(a.dofs()), 0.0);
  for_each_entry(a, [&](Index row, Index, double& value) { row_sum[row] += std::abs(value); });
  for_each_entry(a, [&](Index row, Index column, double& value) {
    if (row == column) value = 1.1 * row_sum[row];
  });
  return a;
}

// Links in one direction only.
std::vector<std::vector<Index>> one_way_graph(Random& random, Index nodes) {
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(nodes));
  for (Index i = 0; i < nodes; ++i)
    for (int e = 0; e < 5; ++e) columns[i].push_back(random.below(nodes));
  return columns;
}

TEST(IncompleteLu, IsAOnItsPattern) {
  Random random(1);
  for (const bool one_way : {false, true})
    for (const Index dim : {3, 1, 0, 0}) {
      const BlockCsr a = random_nonsymmetric(
          random,
          pattern_of(random, one_way ? one_way_graph(random, 50) : random_graph(random, 50, 3, 15),
                     dim));
      BlockIncompleteLu ilu;
      ASSERT_TRUE(ilu.update(a).ok());
      const Eigen::MatrixXd m = dense_inverse(ilu, a.dofs()).inverse();
      EXPECT_LT(difference_on_pattern(m, a), 1e-11 * m.norm());
      EXPECT_GT((m - dense(a)).norm(), 1e-4 * m.norm());
    }
}

TEST(IncompleteLu, IsExactWithoutFill) {
  Random random(2);
  for (const Index dim : {3, 1, 0}) {
    const BlockCsr a = random_nonsymmetric(random, pattern_of(random, chain(200), dim));
    BlockIncompleteLu ilu;
    ASSERT_TRUE(ilu.update(a).ok());
    const std::vector<double> b = random.vector(a.dofs());
    std::vector<double> x(b.size());
    ilu.apply(b, x);
    EXPECT_LT(relative_difference(x, dense(a).partialPivLu().solve(as_eigen(b))), 1e-12);
    std::fill(x.begin(), x.end(), 0.0);
    EXPECT_LE(bicgstab(BlockCsrOperator(a), ilu, b, x, {1e-10, 10, {}}).iterations, 1);
  }
}

TEST(IncompleteLu, OfASymmetricMatrixIsItsIncompleteCholesky) {
  Random random(3);
  const BlockCsr a = random_spd(random, pattern_of(random, random_graph(random, 50, 3, 15), 0));
  BlockIncompleteLu ilu;
  BlockIncompleteCholesky ic;
  ASSERT_TRUE(ilu.update(a).ok() && ic.update(a).ok());
  EXPECT_LT((dense_inverse(ilu, a.dofs()) - dense_inverse(ic, a.dofs())).norm(),
            1e-10 * dense_inverse(ic, a.dofs()).norm());
}

TEST(IncompleteLu, ReportsSingularAndNonFinitePivots) {
  Random random(4);
  BlockCsr a = random_nonsymmetric(random, make_pattern(chain(20), 3));
  BlockIncompleteLu ilu;
  // The first node's block has two equal rows.
  for (Index c = 0; c < 3; ++c) a.block(0, 0)[c] = a.block(0, 0)[a.pattern->width(0) + c] = 1.0;
  const Status singular = ilu.update(a);
  EXPECT_EQ(singular.outcome, Outcome::breakdown);
  EXPECT_NE(singular.message.find("node 0"), std::string::npos) << singular.message;
  a = random_nonsymmetric(random, make_pattern(chain(20), 3));
  a.values[40] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ilu.update(a).outcome, Outcome::not_finite);
}

}  // namespace
}  // namespace taut::test
