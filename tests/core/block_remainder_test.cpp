// What is left out of a preconditioner: A = P + E for any mask, conjugate gradients' product from P
// c and E, the same bits for any threads.

#include "taut/core/block_remainder.h"

#include <gtest/gtest.h>

#include "linalg/spring_grid.h"
#include "taut/base/parallel.h"

namespace taut::test {
namespace {

// As springs' are. A stays symmetric, and is never factorised here.
void make_blocks_symmetric(BlockCsr& a) {
  const BlockPattern& p = *a.pattern;
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
      if (p.dim(i) != 3 || p.dim(p.column[k]) != 3) continue;
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>, 0, Eigen::OuterStride<>> block(
          a.block(i, k), Eigen::OuterStride<>(p.width(i)));
      block = (0.5 * (block + block.transpose())).eval();
    }
}

struct Split {
  BlockCsr a;
  std::vector<std::uint8_t> mask;
  Eigen::MatrixXd p, e;  // dense

  Split(Random& random, std::span<const Index> dims, double share) {
    const Index nodes = static_cast<Index>(dims.size());
    a = random_spd(random, make_pattern(random_graph(random, nodes, 4, 30), dims));
    make_blocks_symmetric(a);
    const BlockPattern& pattern = *a.pattern;
    mask.assign(static_cast<std::size_t>(pattern.blocks()), 1);
    for (Index i = 0; i < nodes; ++i)
      for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k)
        if (pattern.column[k] < i && random.uniform() < share)
          mask[k] = mask[pattern.find(pattern.column[k], i)] = 0;
    e = p = dense(a);
    for (Index i = 0; i < nodes; ++i)
      for (Index j = 0; j < nodes; ++j) {
        const Index k = pattern.find(i, j);
        const bool is_left_out = k >= 0 && i != j && !mask[k];
        (is_left_out ? p : e)
            .block(pattern.dof_start[i], pattern.dof_start[j], pattern.dim(i), pattern.dim(j))
            .setZero();
      }
  }
};

// E's rows sum to zero and P's to A's.
TEST(BlockRemainder, GivesTheProductOfADirection) {
  Random random(31);
  constexpr double unit = 0x1p-24;
  for (const double share : {0.0, 0.5, 1.0}) {
    Split s(random, std::vector<Index>(70, 3), share);
    for (Index i = 0; i < 70; ++i) {
      Mat3 sum = Mat3::Zero();
      for (Index j = 0; j < 70; ++j) sum += s.e.block<3, 3>(3 * i, 3 * j);
      s.e.block<3, 3>(3 * i, 3 * i) -= sum, s.p.block<3, 3>(3 * i, 3 * i) += sum;
    }
    BlockRemainder remainder;
    remainder.analyze(s.a.pattern, s.mask);
    for (int update = 0; update < 2; ++update) {
      // Row by row, from the last on.
      for (Index i = 69; i >= 0; --i) remainder.update_rows(s.a, i, i + 1);
      const std::vector<double> z = random.vector(s.a.dofs()), last = random.vector(s.a.dofs());
      const double beta = update * 0.37;
      const Eigen::VectorXd c = as_eigen(z) + beta * as_eigen(last), r = s.p * as_eigen(z),
                            before = s.p * as_eigen(last);
      std::vector<double> direction(c.begin(), c.end()), residual(r.begin(), r.end()),
          p(before.begin(), before.end()), q(p.size());
      const double energy = remainder.advance(beta, residual, direction, p, q);
      EXPECT_LT((as_eigen(p) - s.p * c).norm(), 1e-12 * (s.p * c).norm());
      EXPECT_LT((as_eigen(q) - s.p * c - s.e * c).norm(),
                unit * s.e.norm() * c.norm() + 1e-12 * s.p.norm() * c.norm());
      EXPECT_NEAR(energy, c.dot(as_eigen(q)), 1e-12 * std::abs(energy));
      for (double& value : s.a.values) value *= 2.0;
      s.p *= 2.0, s.e *= 2.0;
    }
  }
}

// E = A - P for the springs left out and for those replaced, in turn: its product, and the ratios
// that bound it.
TEST(BlockRemainder, KnowsWhatParallelogramsLeave) {
  Random random(34);
  SpringGrid grid(random, 9, 7);
  const BlockPattern& pattern = *grid.a.pattern;
  std::vector<std::uint8_t> kept = grid.sides;
  for (Index i = 0; i < pattern.rows(); ++i)
    for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k)
      if (const Index j = pattern.column[k];
          std::abs(i - j) == grid.nu + 1 && random.uniform() < 0.5)
        kept[k] = kept[pattern.find(j, i)] = 1;
  const std::vector<Parallelogram> list = parallelograms(pattern, grid.sides, kept);
  ASSERT_GT(list.size(), 10u);
  ASSERT_LT(list.size(), 48u);
  BlockRemainder remainder;
  remainder.analyze(grid.a.pattern, kept, list);
  remainder.update(grid.a);
  std::vector<double> masses;
  for (Index i = 0; i < pattern.rows(); ++i) masses.push_back(random.uniform(0.5, 2.0));
  const Eigen::MatrixXd a = dense(grid.a);
  for (const bool replaced : {false, true, false}) {
    remainder.set_replaced(replaced);
    const Eigen::MatrixXd p = dense_core(
        grid.a, kept,
        replaced ? std::span<const Parallelogram>(list) : std::span<const Parallelogram>());
    const std::vector<double> c = random.vector(grid.a.dofs()), r = random.vector(grid.a.dofs());
    std::vector<double> last = random.vector(grid.a.dofs()), q(c.size());
    const Eigen::VectorXd expected = as_eigen(r) + 0.3 * as_eigen(last), e = (a - p) * as_eigen(c);
    const double energy = remainder.advance(0.3, r, c, last, q);
    EXPECT_LT((as_eigen(last) - expected).norm(), 1e-13 * expected.norm());
    EXPECT_LT((as_eigen(q) - expected - e).norm(), 0x1p-22 * e.norm()) << replaced;
    EXPECT_NEAR(energy, as_eigen(c).dot(as_eigen(q)), 1e-12 * std::abs(energy));
    remainder.subtract(c, q);
    EXPECT_LT((as_eigen(q) - expected).norm(), 1e-12 * expected.norm());

    std::vector<Mat3> at_corner(masses.size(), Mat3::Zero()), dropped(masses.size(), Mat3::Zero());
    for (Index i = 0; i < pattern.rows(); ++i)
      for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k)
        if (!kept[k]) dropped[i] -= a.block<3, 3>(3 * i, 3 * pattern.column[k]);
    for (const Parallelogram& of : list) {
      if (!replaced) continue;
      const Mat3 b = -a.block<3, 3>(3 * of.a, 3 * of.c);
      for (const Index i : {of.a, of.b, of.c, of.d}) at_corner[i] += b;
      dropped[of.a] -= b, dropped[of.c] -= b;
    }
    BlockRemainder::Ratios largest;
    for (std::size_t i = 0; i < masses.size(); ++i) {
      largest.dropped = std::max(largest.dropped, dropped[i].norm() / masses[i]);
      largest.replaced = std::max(largest.replaced, at_corner[i].norm() / masses[i]);
    }
    const BlockRemainder::Ratios ratios = remainder.ratios(masses);
    EXPECT_GE(ratios.dropped, largest.dropped);
    EXPECT_GE(ratios.replaced, largest.replaced);
    EXPECT_NEAR(ratios.dropped, largest.dropped, 1e-5 * largest.dropped);
    EXPECT_NEAR(ratios.replaced, largest.replaced, 1e-5 * largest.replaced);
  }
}

// Of more rows than one batch, against the sums written down.
TEST(BlockRemainder, JoinsBatches) {
  Random random(35);
  const SpringGrid grid(random, 37, 29);
  const BlockPattern& pattern = *grid.a.pattern;
  std::vector<std::uint8_t> kept = grid.sides;
  for (Index i = 0; i + grid.nu + 1 < pattern.rows(); ++i)
    if (const Index k = pattern.find(i, i + grid.nu + 1); k >= 0)
      kept[k] = kept[pattern.find(i + grid.nu + 1, i)] = 1;
  const std::vector<Parallelogram> list = parallelograms(pattern, grid.sides, kept);
  ASSERT_GT(list.size(), 500u);
  BlockRemainder remainder;
  remainder.analyze(grid.a.pattern, kept, list);
  ASSERT_GT(remainder.batches(), 3);
  remainder.update(grid.a);
  const std::vector<double> c = random.vector(grid.a.dofs()), r = random.vector(grid.a.dofs()),
                            masses(static_cast<std::size_t>(pattern.rows()), 0.5);
  const auto at = [&](Index i) {
    return Eigen::Map<const Vec3>(&c[3 * static_cast<std::size_t>(i)]);
  };
  const auto block = [&](Index i, Index k) -> Mat3 {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>, 0, Eigen::OuterStride<>>(
        grid.a.block(i, k), Eigen::OuterStride<>(pattern.width(i)));
  };
  for (const bool replaced : {false, true}) {
    remainder.set_replaced(replaced);
    std::vector<std::uint8_t> is_replaced(kept.size(), 0);
    Eigen::VectorXd e = Eigen::VectorXd::Zero(grid.a.dofs());
    std::vector<Mat3> dropped(masses.size(), Mat3::Zero()), at_corner(masses.size(), Mat3::Zero());
    if (replaced)
      for (const Parallelogram& of : list) {
        is_replaced[of.block] = is_replaced[of.opposite] = 1;
        const Mat3 b = block(of.a, of.block);
        const Vec3 force = b * (at(of.a) - at(of.b) + at(of.c) - at(of.d));
        for (const Index i : {of.a, of.c}) e.segment<3>(3 * i) += force;
        for (const Index i : {of.b, of.d}) e.segment<3>(3 * i) -= force;
        for (const Index i : {of.a, of.b, of.c, of.d}) at_corner[i] += b;
      }
    for (Index i = 0; i < pattern.rows(); ++i)
      for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k) {
        if (kept[k] || is_replaced[k] || pattern.column[k] == i) continue;
        e.segment<3>(3 * i) += block(i, k) * (at(pattern.column[k]) - at(i));
        dropped[i] += block(i, k);
      }
    std::vector<double> p(c.size(), std::nan("")), q(c.size());
    remainder.advance(0.0, r, c, p, q);
    EXPECT_EQ(p, r);
    EXPECT_LT((as_eigen(q) - as_eigen(r) - e).norm(), 1e-6 * e.norm()) << replaced;
    const BlockRemainder::Ratios ratios = remainder.ratios(masses);
    const auto largest = [](const std::vector<Mat3>& of) {
      return std::ranges::max(of, {}, [](const Mat3& m) { return m.norm(); }).norm() / 0.5;
    };
    EXPECT_NEAR(ratios.dropped, largest(dropped), 1e-5 * ratios.dropped);
    EXPECT_NEAR(ratios.replaced, largest(at_corner), 1e-5 * ratios.replaced);
  }
}

// What lumping is for: a translation is not in E's way at all, whatever its rounding.
TEST(BlockRemainder, LeavesTranslationsAlone) {
  Random random(33);
  Split s(random, std::vector<Index>(70, 3), 0.5);
  BlockRemainder remainder;
  remainder.analyze(s.a.pattern, s.mask);
  remainder.update(s.a);
  const std::vector<double> r = random.vector(s.a.dofs());
  std::vector<double> translation(r.size()), p(r.size()), q(r.size());
  for (std::size_t k = 0; k < r.size(); ++k) translation[k] = 0.1 * static_cast<double>(k % 3 + 1);
  remainder.advance(0.0, r, translation, p, q);
  EXPECT_EQ(p, r);
  EXPECT_EQ(q, r);
}

TEST(BlockRemainder, DeterministicForAnyNumberOfThreads) {
  Random random(32);
  const SpringGrid s(random, 60, 50);
  std::vector<std::uint8_t> kept = s.sides;
  for (Index i = 0; i + s.nu + 1 < s.a.rows(); ++i)
    if (const Index k = s.a.pattern->find(i, i + s.nu + 1); k >= 0)
      kept[k] = kept[s.a.pattern->find(i + s.nu + 1, i)] = 1;
  BlockRemainder remainder;
  remainder.analyze(s.a.pattern, kept, parallelograms(*s.a.pattern, s.sides, kept));
  remainder.set_replaced(true);
  const std::vector<double> r = random.vector(s.a.dofs()), c = random.vector(s.a.dofs()),
                            start = random.vector(s.a.dofs());
  const int usual = thread_count();
  std::vector<double> expected;
  double energy = 0.0;
  for (const int threads : {1, 2, 3, 4}) {
    set_thread_count(threads);
    remainder.update(s.a);
    std::vector<double> p = start, q(p.size());
    const double now = remainder.advance(0.5, r, c, p, q);
    if (threads == 1) expected = q, energy = now;
    EXPECT_TRUE(q == expected && now == energy) << threads << " threads";
  }
  set_thread_count(usual);
}

}  // namespace
}  // namespace taut::test
