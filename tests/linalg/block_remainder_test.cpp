// What is left out of a preconditioner: A = P + E for any mask, conjugate gradients' product from P c and E, the same bits for any threads.

#include "taut/linalg/block_remainder.h"

#include <gtest/gtest.h>

#include "linalg/random_matrix.h"
#include "taut/base/parallel.h"

namespace taut::test {
namespace {

struct Split {
  BlockCsr a;
  std::vector<std::uint8_t> mask;
  Eigen::MatrixXd p, e;  // dense

  Split(Random& random, std::span<const Index> dims, double share) {
    const Index nodes = static_cast<Index>(dims.size());
    a = random_spd(random, make_pattern(random_graph(random, nodes, 4, 30), dims));
    const BlockPattern& pattern = *a.pattern;
    mask.assign(static_cast<std::size_t>(pattern.blocks()), 1);
    for (Index i = 0; i < nodes; ++i)
      for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k)
        if (pattern.column[k] < i && random.uniform() < share) mask[k] = mask[pattern.find(pattern.column[k], i)] = 0;
    e = p = dense(a);
    for (Index i = 0; i < nodes; ++i)
      for (Index j = 0; j < nodes; ++j) {
        const Index k = pattern.find(i, j);
        const bool is_left_out = k >= 0 && i != j && !mask[k];
        (is_left_out ? p : e).block(pattern.dof_start[i], pattern.dof_start[j], pattern.dim(i), pattern.dim(j)).setZero();
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
      const Eigen::VectorXd c = as_eigen(z) + beta * as_eigen(last), r = s.p * as_eigen(z), before = s.p * as_eigen(last);
      std::vector<double> direction(c.begin(), c.end()), residual(r.begin(), r.end()), p(before.begin(), before.end()), q(p.size());
      const double energy = remainder.advance(beta, residual, direction, p, q);
      EXPECT_LT((as_eigen(p) - s.p * c).norm(), 1e-12 * (s.p * c).norm());
      EXPECT_LT((as_eigen(q) - s.p * c - s.e * c).norm(), unit * s.e.norm() * c.norm() + 1e-12 * s.p.norm() * c.norm());
      EXPECT_NEAR(energy, c.dot(as_eigen(q)), 1e-12 * std::abs(energy));
      for (double& value : s.a.values) value *= 2.0;
      s.p *= 2.0, s.e *= 2.0;
    }
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
  Split s(random, std::vector<Index>(3000, 3), 0.5);
  BlockRemainder remainder;
  remainder.analyze(s.a.pattern, s.mask);
  const std::vector<double> r = random.vector(s.a.dofs()), c = random.vector(s.a.dofs()), start = random.vector(s.a.dofs());
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
