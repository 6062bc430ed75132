// Factorising a part of Qᵀ A Q straight from A, against dense matrices.

#include <gtest/gtest.h>

#include <limits>

#include "linalg/spring_grid.h"
#include "taut/base/parallel.h"
#include "taut/linalg/block_cholesky.h"

namespace taut::test {
namespace {

struct Basis {
  std::vector<std::int8_t> dim;
  std::vector<Mat3> frame;
  NodeBasis view() const { return {dim, frame}; }
  Eigen::MatrixXd dense() const {
    Index columns = 0, column = 0;
    for (const int d : dim) columns += d;
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(3 * static_cast<Index>(dim.size()), columns);
    for (std::size_t i = 0; i < dim.size(); ++i)
      for (int c = 0; c < dim[i]; ++c) {
        const Vec3 direction = dim[i] == 3 ? Vec3(Vec3::Unit(c)) : Vec3(frame[i].col(c));
        q.block<3, 1>(3 * static_cast<Index>(i), column++) = direction;
      }
    return q;
  }
};

Basis random_basis(Random& random, Index nodes) {
  Basis basis;
  for (Index i = 0; i < nodes; ++i) {
    basis.dim.push_back(static_cast<std::int8_t>(random.below(2) ? 3 : random.below(3)));
    Mat3 m;
    for (int c = 0; c < 3; ++c) m.col(c) = random.direction();
    basis.frame.push_back(m.householderQr().householderQ());
  }
  return basis;
}

struct BasisCase {
  BlockCsr a;
  std::vector<std::uint8_t> mask;
  Basis basis;
  Eigen::MatrixXd part() const {  // of Qᵀ A Q
    BlockCsr masked = a;
    const BlockPattern& p = *a.pattern;
    for (Index i = 0; i < p.rows(); ++i)
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
        for (Index r = 0; r < 3; ++r)
          for (Index c = 0; c < 3; ++c)
            if (!mask[k] && p.column[k] != i) masked.block(i, k)[r * p.width(i) + c] = 0.0;
    const Eigen::MatrixXd q = basis.dense();
    return q.transpose() * dense(masked) * q;
  }
};

BasisCase random_case(Random& random, Index nodes) {
  BasisCase c{random_spd(random, make_pattern(random_graph(random, nodes, 4, 30), 3), 1e-2),
              {},
              random_basis(random, nodes)};
  const BlockPattern& p = *c.a.pattern;
  for (Index i = 0; i < nodes; ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      c.mask.push_back((i + p.column[k]) % 3 != 0);
  return c;
}

class BlockFactorBasis : public testing::TestWithParam<CholeskyPrecision> {
 protected:
  double tolerance() const {
    return GetParam() == CholeskyPrecision::double_precision ? 1e-11 : 3e-5;
  }
  BlockCholesky cholesky_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Precisions, BlockFactorBasis,
                         testing::Values(CholeskyPrecision::double_precision,
                                         CholeskyPrecision::single_precision),
                         [](const auto& p) {
                           return p.param == CholeskyPrecision::double_precision ? "double"
                                                                                 : "single";
                         });

// `size`: of b, to see that single precision does not run out of range.
void expect_solves(BlockCholesky& cholesky, const BasisCase& c, Random& random, double tolerance,
                   double size) {
  std::vector<double> b = random.vector(c.a.dofs());
  for (double& value : b) value *= size;
  double norm2 = -1.0;
  const Status status = cholesky.factorize(c.a, c.basis.view(), b, &norm2);
  ASSERT_TRUE(status.ok()) << status.message;
  const Eigen::MatrixXd q = c.basis.dense();
  const Eigen::VectorXd reduced = c.part().llt().solve(q.transpose() * as_eigen(b));
  const double expected_norm2 = as_eigen(b).dot(q * reduced);
  EXPECT_NEAR(norm2, expected_norm2, tolerance * expected_norm2);
  std::vector<double> x(b.size(), std::numeric_limits<double>::quiet_NaN());
  cholesky.solve_backward(0.0, x);
  EXPECT_LT(relative_difference(x, q * reduced), tolerance);
  // Whatever the precision of the factor, nothing comes out in directions that are not the basis's:
  // conjugate gradients would amplify it.
  EXPECT_LT((as_eigen(x) - q * (q.transpose() * as_eigen(x))).norm(), 1e-14 * as_eigen(x).norm());

  // Again, apart from the factorisation, and added to what was there.
  const std::vector<double> before = random.vector(c.a.dofs());
  x = before;
  EXPECT_EQ(cholesky.solve_forward(b), norm2);
  cholesky.solve_backward(0.5 * size, x);
  EXPECT_LT(relative_difference(x, 0.5 * size * as_eigen(before) + q * reduced), tolerance);
}

TEST_P(BlockFactorBasis, SolvesThePartInTheBasis) {
  Random random(1);
  for (const Index nodes : {1, 5, 40, 140}) {
    BasisCase c = random_case(random, nodes);
    ASSERT_TRUE(cholesky_.analyze(c.a.pattern, c.mask).ok());
    for (const double size : {1.0, 1e-30, 1e30}) {
      c.a.values = random_spd(random, c.a.pattern, 1e-2).values;
      c.basis = random_basis(random, nodes);
      expect_solves(cholesky_, c, random, tolerance(), size);
    }
  }
}

// Nodes eliminated before the fronts, and their neighbours, with bases of their own.
TEST_P(BlockFactorBasis, CondensesNodesInTheBasis) {
  Random random(8);
  for (const Index nodes : {2, 9, 40, 140}) {
    BasisCase c{
        random_spd(random, make_pattern(random_graph(random, nodes, 1, 15), 3), 1e-2), {}, {}};
    c.mask.assign(static_cast<std::size_t>(c.a.pattern->blocks()), 1);
    ASSERT_TRUE(cholesky_.analyze(c.a.pattern, c.mask).ok());
    ASSERT_GT(cholesky_.block_statistics().condensed, 0);
    for (const double size : {1.0, 1e-30, 1e30}) {
      c.basis = random_basis(random, nodes);
      expect_solves(cholesky_, c, random, tolerance(), size);
    }
  }
}

// Blocks outside the mask that the factor has a place for: taken in, the factor stays as large.
TEST_P(BlockFactorBasis, TakesInWhatHasAPlace) {
  Random random(4);
  int taken = 0, left = 0;
  for (const Index nodes : {5, 40, 140}) {
    BasisCase c = random_case(random, nodes);
    ASSERT_TRUE(cholesky_.analyze(c.a.pattern, c.mask).ok());
    const BlockCholeskyStatistics without = cholesky_.block_statistics();
    ASSERT_TRUE(cholesky_.analyze(c.a.pattern, c.mask, BlocksLeftOut::without_place).ok());
    const BlockCholeskyStatistics with = cholesky_.block_statistics();
    EXPECT_EQ(with.factor_entries, without.factor_entries);
    EXPECT_EQ(with.panel_bytes, without.panel_bytes);
    EXPECT_EQ(with.padded_flops, without.padded_flops);

    const std::vector<std::uint8_t> blocks(cholesky_.analyzed_blocks().begin(),
                                           cholesky_.analyzed_blocks().end());
    ASSERT_EQ(blocks.size(), c.mask.size());
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      EXPECT_GE(blocks[k], c.mask[k]);
      taken += blocks[k] > c.mask[k], left += blocks[k] == 0;
    }
    c.mask = blocks;
    expect_solves(cholesky_, c, random, tolerance(), 1.0);
  }
  EXPECT_GT(taken, 20);
  EXPECT_GT(left, 20);
}

// Springs outside the mask, lumped: what is factorised is the matrix of the others, with
// constraints and without, however many threads.
TEST_P(BlockFactorBasis, WithoutTheSpringsOutside) {
  Random random(5);
  for (const Index nodes : {2, 40, 400}) {
    BasisCase c = random_case(random, nodes);
    const BlockPattern& p = *c.a.pattern;
    BlockCsr inside(c.a.pattern);
    for (BlockCsr* a : {&c.a, &inside}) std::ranges::fill(a->values, 0.0);
    const auto add = [&](BlockCsr& a, Index i, Index j, const Mat3& block) {
      for (Index r = 0; r < 3; ++r)
        for (Index column = 0; column < 3; ++column)
          a.block(i, p.find(i, j))[r * p.width(i) + column] += block(r, column);
    };
    for (Index i = 0; i < nodes; ++i) {
      for (BlockCsr* a : {&c.a, &inside}) add(*a, i, i, Mat3::Identity());
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
        const Index j = p.column[k];
        if (j <= i) continue;
        c.mask[p.find(j, i)] = c.mask[k];
        const Vec3 e = random.direction();
        const Mat3 spring = 10.0 * e * e.transpose();
        for (BlockCsr* a : {&c.a, &inside}) {
          if (a == &inside && !c.mask[k]) continue;
          add(*a, i, i, spring), add(*a, j, j, spring), add(*a, i, j, -spring),
              add(*a, j, i, -spring);
        }
      }
    }
    ASSERT_TRUE(cholesky_.analyze(c.a.pattern, c.mask).ok());
    const std::vector<double> b = random.vector(c.a.dofs());
    for (const bool held : {false, true}) {
      const Eigen::MatrixXd q =
          held ? c.basis.dense() : Eigen::MatrixXd::Identity(3 * nodes, 3 * nodes);
      const Eigen::VectorXd expected =
          q * (q.transpose() * dense(inside) * q).llt().solve(q.transpose() * as_eigen(b));
      std::vector<int> seen(static_cast<std::size_t>(nodes), 0);
      const BlocksOutside outside{true, false, [&](Index begin, Index end) {
                                    for (Index i = begin; i < end; ++i) ++seen[i];
                                  }};
      std::vector<double> x(b.size());
      ASSERT_TRUE(
          cholesky_.factorize(c.a, held ? c.basis.view() : NodeBasis{}, b, nullptr, outside).ok());
      cholesky_.solve_backward(0.0, x);
      EXPECT_LT(relative_difference(x, expected), tolerance()) << nodes << (held ? ", held" : "");
      EXPECT_EQ(std::ranges::count(seen, 1), nodes) << "each row is to be seen once";
    }
  }
}

// Parallelograms in the place of some of them, in A's last row too; on and off in turn.
TEST_P(BlockFactorBasis, WithParallelogramsForSpringsOutside) {
  Random random(6);
  for (const Index side : {5, 6, 12}) {
    const SpringGrid grid(random, side, side + 1);
    const Index nodes = grid.a.rows();
    const Basis basis = random_basis(random, nodes);
    ASSERT_TRUE(cholesky_.analyze(grid.a.pattern, grid.sides, BlocksLeftOut::without_place).ok());
    const auto list = cholesky_.parallelograms();
    ASSERT_GT(static_cast<Index>(list.size()), nodes / 10);
    const std::vector<double> b = random.vector(grid.a.dofs());
    for (const bool held : {false, true})
      for (const bool replaced : {true, false, true}) {
        const Eigen::MatrixXd q =
            held ? basis.dense() : Eigen::MatrixXd::Identity(3 * nodes, 3 * nodes);
        const Eigen::MatrixXd p = dense_core(grid.a, cholesky_.analyzed_blocks(),
                                             replaced ? list : std::span<const Parallelogram>());
        const Eigen::VectorXd expected =
            q * (q.transpose() * p * q).llt().solve(q.transpose() * as_eigen(b));
        std::vector<double> x(b.size());
        ASSERT_TRUE(cholesky_
                        .factorize(grid.a, held ? basis.view() : NodeBasis{}, b, nullptr,
                                   {true, replaced, {}})
                        .ok());
        cholesky_.solve_backward(0.0, x);
        EXPECT_LT(relative_difference(x, expected), tolerance())
            << nodes << (held ? ", held" : "") << (replaced ? ", replaced" : "");
      }
  }
}

TEST_P(BlockFactorBasis, ParallelogramsGiveTheSameBitsForAnyNumberOfThreads) {
  Random random(7);
  const SpringGrid grid(random, 45, 40);
  const std::vector<double> b = random.vector(grid.a.dofs());
  ASSERT_TRUE(cholesky_.analyze(grid.a.pattern, grid.sides, BlocksLeftOut::without_place).ok());
  ASSERT_FALSE(cholesky_.parallelograms().empty());
  const int usual = thread_count();
  std::vector<double> x(b.size()), first;
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    ASSERT_TRUE(cholesky_.factorize(grid.a, {}, b, nullptr, {true, true, {}}).ok());
    cholesky_.solve_backward(0.0, x);
    if (first.empty()) first = x;
    EXPECT_EQ(x, first) << threads << " threads";
  }
  set_thread_count(usual);
}

TEST_P(BlockFactorBasis, WithoutBasisAndMask) {
  Random random(2);
  const BlockCsr a = random_spd(
      random, make_pattern(random_graph(random, 50, 3, 20), random_dims(random, 50)), 1e-2);
  ASSERT_TRUE(cholesky_.analyze(a.pattern, {}).ok());
  const std::vector<double> b = random.vector(a.dofs());
  std::vector<double> x(b.size());
  ASSERT_TRUE(cholesky_.factorize(a, {}, b).ok());
  cholesky_.solve_backward(0.0, x);
  EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), tolerance());
}

TEST_P(BlockFactorBasis, TwoLoadsOnTheWayAreTheTwoSolvesAfterwards) {
  Random random(3);
  const BasisCase c = random_case(random, 90);
  ASSERT_TRUE(cholesky_.analyze(c.a.pattern, c.mask).ok());
  const std::vector<double> b = random.vector(c.a.dofs());
  std::vector<double> r = random.vector(c.a.dofs()), on_the_way(r.size()), afterwards(r.size());
  for (double& value : r) value *= 1e-25;
  double b_norm2 = -1.0, r_norm2 = -1.0;
  ASSERT_TRUE(cholesky_.factorize(c.a, c.basis.view(), b, b_norm2, r, r_norm2).ok());
  cholesky_.solve_backward(0.0, on_the_way);
  EXPECT_EQ(cholesky_.solve_forward(b), b_norm2);
  EXPECT_EQ(cholesky_.solve_forward(r), r_norm2);
  cholesky_.solve_backward(0.0, afterwards);
  EXPECT_EQ(on_the_way, afterwards);
}

}  // namespace
}  // namespace taut::test
