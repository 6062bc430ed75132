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

TEST(BlockRemainder, GivesTheProductOfADirection) {
  Random random(31);
  for (const bool mixed : {false, true})
    for (const double share : {0.0, 0.5, 1.0}) {
      const std::vector<Index> dims = mixed ? random_dims(random, 70) : std::vector<Index>(70, 3);
      Split s(random, dims, share);
      BlockRemainder remainder;
      remainder.analyze(s.a.pattern, s.mask);
      for (int update = 0; update < 2; ++update) {
        remainder.update(s.a);
        const std::vector<double> z = random.vector(s.a.dofs()), last = random.vector(s.a.dofs());
        const double beta = 0.37;
        const Eigen::VectorXd c = as_eigen(z) + beta * as_eigen(last), r = s.p * as_eigen(z), before = s.p * as_eigen(last);
        std::vector<double> direction(c.begin(), c.end()), residual(r.begin(), r.end()), p(before.begin(), before.end()), q(p.size());
        const double energy = remainder.advance(false, beta, residual, direction, p, q);
        EXPECT_LT((as_eigen(p) - s.p * c).norm(), 1e-12 * (s.p * c).norm());
        EXPECT_LT((as_eigen(q) - (s.p + s.e) * c).norm(), 1e-12 * c.norm() * s.p.norm());
        EXPECT_NEAR(energy, c.dot(dense(s.a) * c), 1e-12 * std::abs(energy));
        for (double& value : s.a.values) value *= 2.0;
        s.p *= 2.0, s.e *= 2.0;
      }
    }
}

// Lumped, E's rows sum to zero and P's to A's.
TEST(BlockRemainder, GivesTheProductWhereTheOthersAreLumped) {
  Random random(33);
  for (const double share : {0.0, 0.5, 1.0}) {
    Split s(random, std::vector<Index>(70, 3), share);
    for (Index i = 0; i < 70; ++i) {
      Mat3 sum = Mat3::Zero();
      for (Index j = 0; j < 70; ++j) sum += s.e.block<3, 3>(3 * i, 3 * j);
      s.e.block<3, 3>(3 * i, 3 * i) -= sum, s.p.block<3, 3>(3 * i, 3 * i) += sum;
    }
    BlockRemainder remainder;
    remainder.analyze(s.a.pattern, s.mask);
    // Row by row, from the last on.
    for (Index i = 69; i >= 0; --i) remainder.update_rows(s.a, i, i + 1);
    const std::vector<double> c = random.vector(s.a.dofs());
    const Eigen::VectorXd r = s.p * as_eigen(c);
    std::vector<double> residual(r.begin(), r.end()), p(residual.size(), 7.0), q(p.size());
    const double energy = remainder.advance(true, 0.0, residual, c, p, q);
    EXPECT_EQ(p, residual);
    EXPECT_LT((as_eigen(q) - dense(s.a) * as_eigen(c)).norm(), 1e-12 * as_eigen(q).norm());
    EXPECT_NEAR(energy, as_eigen(c).dot(dense(s.a) * as_eigen(c)), 1e-12 * std::abs(energy));
  }
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
    const double now = remainder.advance(false, 0.5, r, c, p, q);
    if (threads == 1) expected = q, energy = now;
    EXPECT_TRUE(q == expected && now == energy) << threads << " threads";
  }
  set_thread_count(usual);
}

}  // namespace
}  // namespace taut::test
