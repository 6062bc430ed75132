#include "taut/linalg/block_csr.h"

#include <gtest/gtest.h>

#include "linalg/random_matrix.h"
#include "taut/linalg/sparse_cholesky.h"
#include "taut/linalg/vector_ops.h"

namespace taut::test {
namespace {

// Product, its dot, diagonal and single entries against the dense matrix.
void compare_with_dense(const BlockCsr& a, Random& random) {
  const Eigen::MatrixXd d = dense(a);
  const std::vector<double> x = random.vector(a.dofs());
  std::vector<double> y(x.size(), 1e300), y_dot(x.size(), 1e300);
  multiply(a, x, y);
  const double xax = multiply_dot(a, x, y_dot);
  const Eigen::VectorXd expected = d * as_eigen(x);
  EXPECT_LT(relative_difference(y, expected), 1e-14);
  EXPECT_EQ(y, y_dot);
  EXPECT_NEAR(xax, as_eigen(x).dot(expected), 1e-13 * as_eigen(x).norm() * expected.norm());
  EXPECT_EQ(relative_difference(diagonal_of(a), d.diagonal()), 0.0);
  for (int trial = 0; trial < 200; ++trial) {
    const Index i = random.below(a.dofs()), j = random.below(a.dofs());
    EXPECT_EQ(a.at(i, j), d(i, j));
  }
}

TEST(BlockProduct, UniformBlocksAgainstDense) {
  Random random(1);
  for (const Index dim : {1, 2, 3}) {
    SCOPED_TRACE(dim);
    const auto pattern = make_pattern(random_graph(random, 150, 5, 40), dim);
    EXPECT_EQ(pattern->uniform_dim, dim);
    EXPECT_EQ(pattern->dofs(), 150 * dim);
    compare_with_dense(random_matrix(random, pattern), random);
  }
}

TEST(BlockProduct, MixedBlocksAgainstDense) {
  Random random(2);
  for (int trial = 0; trial < 5; ++trial) {
    const auto dims = random_dims(random, 150);
    const auto pattern = make_pattern(random_graph(random, 150, 5, 40), dims);
    EXPECT_EQ(pattern->uniform_dim, 0);
    compare_with_dense(random_matrix(random, pattern), random);
  }
}

// Rows longer than the product's buffer of 192 gathered entries, whose pieces end inside and
// between blocks.
TEST(BlockProduct, FullRowsAgainstDense) {
  Random random(3);
  for (const Index nodes : {63, 64, 65, 128, 129, 200}) {
    std::vector<std::vector<Index>> columns(static_cast<std::size_t>(nodes));
    for (auto& row : columns)
      for (Index j = 0; j < nodes; ++j) row.push_back(j);
    for (const Index dim : {1, 2, 3})
      compare_with_dense(random_matrix(random, make_pattern(columns, dim)), random);
    compare_with_dense(random_matrix(random, make_pattern(columns, random_dims(random, nodes))),
                       random);
  }
}

TEST(BlockProduct, NoUnknowns) {
  for (const Index dim : {0, 3}) {
    const BlockCsr a(make_pattern(std::vector<std::vector<Index>>(dim == 0 ? 5 : 0), dim));
    EXPECT_EQ(a.dofs(), 0);
    std::vector<double> nothing;
    EXPECT_EQ(multiply_dot(a, nothing, nothing), 0.0);
    EXPECT_TRUE(diagonal_of(a).empty());
  }
}

TEST(BlockPattern, SortsMergesAndAddsTheDiagonal) {
  const std::vector<Index> dims = {3, 0, 2};
  const auto p = make_pattern({{2, 2}, {}, {1, 0}}, dims);
  EXPECT_EQ(p->column, (std::vector<Index>{0, 2, 1, 0, 1, 2}));
  EXPECT_EQ(p->row_start, (std::vector<Index>{0, 2, 3, 6}));
  EXPECT_EQ(p->diagonal, (std::vector<Index>{0, 2, 5}));
  EXPECT_EQ(p->block_offset, (std::vector<Index>{0, 3, 0, 0, 3, 3}));
  EXPECT_EQ(p->value_start, (std::vector<Offset>{0, 15, 15, 25}));
  EXPECT_EQ(p->find(0, 2), 1);
  EXPECT_EQ(p->find(0, 1), -1);
}

TEST(LowerTriangle, AgainstDense) {
  Random random(4);
  for (int trial = 0; trial < 3; ++trial) {
    const auto graph = random_graph(random, 60, 4, 30);
    const BlockCsr a = random_spd(
        random, trial == 0 ? make_pattern(graph, 3) : make_pattern(graph, random_dims(random, 60)));
    ScalarCsc csc;
    lower_triangle(a, csc);
    ASSERT_EQ(static_cast<Index>(csc.column_start.size()), a.dofs() + 1);
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(a.dofs(), a.dofs());
    for (Index j = 0; j < a.dofs(); ++j)
      for (Index k = csc.column_start[j]; k < csc.column_start[j + 1]; ++k) {
        EXPECT_GE(csc.row[k], j);
        EXPECT_TRUE(k == csc.column_start[j] || csc.row[k] > csc.row[k - 1]);
        lower(csc.row[k], j) = csc.value[k];
      }
    EXPECT_EQ((lower - Eigen::MatrixXd(dense(a).triangularView<Eigen::Lower>())).norm(), 0.0);
  }
}

TEST(VectorOps, AgainstEigen) {
  Random random(5);
  for (const Index n : {0, 1, 7, 2048, 40'001}) {
    const std::vector<double> a = random.vector(n), b = random.vector(n);
    const Eigen::VectorXd ea = as_eigen(a), eb = as_eigen(b);
    EXPECT_NEAR(dot(a, b), ea.dot(eb), 1e-12 * (1.0 + ea.norm() * eb.norm()));
    EXPECT_NEAR(norm(a), ea.norm(), 1e-12 * (1.0 + ea.norm()));
    std::vector<double> y = b;
    add_scaled(0.7, a, y);
    EXPECT_LE((as_eigen(y) - (eb + 0.7 * ea)).norm(), 1e-14 * (1.0 + eb.norm()));
    y = b, scale_add(-0.3, a, y);
    EXPECT_LE((as_eigen(y) - (ea - 0.3 * eb)).norm(), 1e-14 * (1.0 + eb.norm()));
    y = b, residual_from_product(a, y);
    EXPECT_EQ((as_eigen(y) - (ea - eb)).norm(), 0.0);
  }
}

TEST(VectorOps, FindsNonFiniteEntries) {
  std::vector<double> v(1000, 1.0);
  EXPECT_TRUE(all_finite(v));
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    v[999] = bad;
    EXPECT_FALSE(all_finite(v));
  }
}

}  // namespace
}  // namespace taut::test
