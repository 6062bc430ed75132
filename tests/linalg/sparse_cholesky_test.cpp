// Every factorisation that is registered in this program: the test program of linalg has Taut's own
// and Eigen's, that of taut_cholmod has CHOLMOD's too.

#include "taut/linalg/sparse_cholesky.h"

#include <gtest/gtest.h>

#include <limits>

#include "linalg/random_matrix.h"

namespace taut::test {
namespace {

class Cholesky : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<SparseCholesky> cholesky_ = make_cholesky(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Backends, Cholesky, testing::ValuesIn(cholesky_names()),
                         [](const auto& backend) { return backend.param; });

BlockCsr mixed_spd(Random& random, Index nodes) {
  const auto dims = random_dims(random, nodes);
  return random_spd(random, make_pattern(random_graph(random, nodes, 3, 25), dims), 1e-2);
}

// 3x3 blocks with much fill-in, so that CHOLMOD takes its supernodal way.
BlockCsr supernodal_spd(Random& random) {
  return random_spd(random, make_pattern(random_graph(random, 200, 6, 150), 3), 1e-2);
}

// Of a solution, relative. Single precision: the matrices here have condition numbers of some
// hundreds.
double tolerance(const SparseCholesky& cholesky) {
  return cholesky.name() == "block_single" ? 3e-5 : 1e-11;
}

void expect_solves(SparseCholesky& cholesky, const BlockCsr& a, Random& random) {
  const std::vector<double> b = random.vector(a.dofs());
  std::vector<double> x(b.size());
  ASSERT_TRUE(cholesky.solve(b, x).ok());
  const Eigen::VectorXd expected = dense(a).llt().solve(as_eigen(b));
  EXPECT_LT(relative_difference(x, expected), tolerance(cholesky));
  std::vector<double> in_place = b;
  ASSERT_TRUE(cholesky.solve(in_place, in_place).ok());
  EXPECT_EQ(in_place, x);
}

TEST_P(Cholesky, SolvesAgainstDense) {
  Random random(1);
  EXPECT_EQ(cholesky_->name(), GetParam());
  for (int trial = 0; trial < 4; ++trial) {
    const BlockCsr a = trial == 3 ? supernodal_spd(random) : mixed_spd(random, 60);
    ASSERT_TRUE(cholesky_->analyze(a).ok());
    ASSERT_TRUE(cholesky_->factorize(a).ok());
    expect_solves(*cholesky_, a, random);
  }
}

TEST_P(Cholesky, NewNumbersInTheAnalysedPattern) {
  Random random(2);
  for (const bool supernodal : {false, true}) {
    BlockCsr a = supernodal ? supernodal_spd(random) : mixed_spd(random, 60);
    ASSERT_TRUE(cholesky_->analyze(a).ok());
    for (int refactor = 0; refactor < 3; ++refactor) {
      a.values = random_spd(random, a.pattern, 0.1).values;
      ASSERT_TRUE(cholesky_->factorize(a).ok());
      expect_solves(*cholesky_, a, random);
    }
  }
}

TEST_P(Cholesky, PermutedSolveIsThatOfThePermutedMatrix) {
  Random random(3);
  for (const bool supernodal : {false, true}) {
    const BlockCsr a = supernodal ? supernodal_spd(random) : mixed_spd(random, 60);
    ASSERT_TRUE(cholesky_->analyze(a).ok() && cholesky_->factorize(a).ok());
    const auto perm = cholesky_->permutation();
    ASSERT_EQ(static_cast<Index>(perm.size()), a.dofs());
    const Eigen::MatrixXd d = dense(a);
    Eigen::MatrixXd permuted(a.dofs(), a.dofs());  // Π A Πᵀ
    std::vector<bool> seen(perm.size(), false);
    for (Index i = 0; i < a.dofs(); ++i) {
      EXPECT_FALSE(seen[perm[i]]);
      seen[perm[i]] = true;
      for (Index j = 0; j < a.dofs(); ++j) permuted(i, j) = d(perm[i], perm[j]);
    }
    const std::vector<double> b = random.vector(a.dofs());
    std::vector<double> x(b.size());
    ASSERT_TRUE(cholesky_->solve_permuted(b, x).ok());
    EXPECT_LT(relative_difference(x, permuted.llt().solve(as_eigen(b))), tolerance(*cholesky_));
  }
}

// The fill-in counted by a dense elimination of the permuted pattern: what statistics() says must
// be at least this, and not much more.
TEST_P(Cholesky, StatisticsCountTheFactor) {
  Random random(4);
  const BlockCsr a = random_spd(random, make_pattern(random_graph(random, 60, 2, 20), 3), 1e-2);
  ASSERT_TRUE(cholesky_->analyze(a).ok() && cholesky_->factorize(a).ok());
  const auto perm = cholesky_->permutation();
  const Eigen::MatrixXd d = dense(a);
  Eigen::MatrixXd permuted(a.dofs(), a.dofs());
  for (Index i = 0; i < a.dofs(); ++i)
    for (Index j = 0; j < a.dofs(); ++j) permuted(i, j) = d(perm[i], perm[j]);
  const Eigen::MatrixXd l = permuted.llt().matrixL();
  const double nonzeros = static_cast<double>((l.array().abs() > 1e-15).count());
  const FactorStatistics statistics = cholesky_->statistics();
  // With or without the diagonal (LLᵀ or LDLᵀ), and supernodes may store some zeros. Block Cholesky
  // counts before it merges supernodes and orders their pivots anew, which fills in a little more.
  const double more = GetParam().starts_with("block") ? 1.25 : 1.0;
  EXPECT_GE(more * statistics.nonzeros, nonzeros - a.dofs());
  EXPECT_LE(statistics.nonzeros, 1.5 * nonzeros);
  EXPECT_GE(statistics.bytes, (GetParam() == "block_single" ? 4.0 : 8.0) * statistics.nonzeros);
  EXPECT_FALSE(statistics.ordering.empty());
}

void expect_refused(SparseCholesky& cholesky, const BlockCsr& a, Index unknown) {
  ASSERT_TRUE(cholesky.analyze(a).ok());
  const Status status = cholesky.factorize(a);
  EXPECT_EQ(status.outcome, Outcome::not_positive_definite) << name_of(status.outcome);
  if (unknown >= 0) {
    EXPECT_NE(status.message.find("unknown " + std::to_string(unknown)), std::string::npos)
        << status.message;
  }
}

TEST_P(Cholesky, ReportsTheUnknownThatIsNotPositive) {
  for (const double bad : {-2.0, 0.0}) {
    BlockCsr a(make_pattern({{1}, {0}, {}, {4}, {3}}, 1));
    for_each_entry(
        a, [](Index row, Index column, double& value) { value = row == column ? 3.0 : 1.0; });
    // a node of its own: the pivot is the entry itself
    a.block(2, a.pattern->diagonal[2])[0] = bad;
    expect_refused(*cholesky_, a, bad < 0.0 ? 2 : -1);
  }
}

TEST_P(Cholesky, ReportsAnIndefiniteMatrix) {
  Random random(5);
  for (const bool supernodal : {false, true}) {
    BlockCsr a = supernodal ? supernodal_spd(random) : mixed_spd(random, 60);
    // All diagonal entries stay positive.
    for_each_entry(a, [](Index row, Index column, double& value) {
      if (row == column) value *= 0.2;
    });
    ASSERT_LT(dense(a).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-3);
    expect_refused(*cholesky_, a, -1);
  }
}

TEST_P(Cholesky, ReportsNaN) {
  Random random(6);
  for (const bool supernodal : {false, true}) {
    BlockCsr a = supernodal ? supernodal_spd(random) : mixed_spd(random, 60);
    for_each_entry(a, [](Index row, Index column, double& value) {
      if (row == 30 && column == 30) value = std::numeric_limits<double>::quiet_NaN();
    });
    ASSERT_TRUE(cholesky_->analyze(a).ok());
    EXPECT_FALSE(cholesky_->factorize(a).ok());
  }
}

TEST_P(Cholesky, RecoversFromARefusedMatrix) {
  Random random(7);
  const BlockCsr good = mixed_spd(random, 60);
  BlockCsr bad = good;
  for (double& value : bad.values) value = -value;
  ASSERT_TRUE(cholesky_->analyze(good).ok());
  EXPECT_FALSE(cholesky_->factorize(bad).ok());
  ASSERT_TRUE(cholesky_->factorize(good).ok());
  expect_solves(*cholesky_, good, random);
}

TEST_P(Cholesky, NoUnknowns) {
  const BlockCsr a(make_pattern(std::vector<std::vector<Index>>(4), 0));
  std::vector<double> nothing;
  EXPECT_TRUE(cholesky_->analyze(a).ok());
  EXPECT_TRUE(cholesky_->factorize(a).ok());
  EXPECT_TRUE(cholesky_->solve(nothing, nothing).ok());
  EXPECT_TRUE(cholesky_->solve_permuted(nothing, nothing).ok());
}

TEST(CholeskyNames, FindsBackendsByName) {
  EXPECT_EQ(make_cholesky("no such backend"), nullptr);
  for (const std::string& name : cholesky_names()) EXPECT_NE(make_cholesky(name), nullptr);
}

}  // namespace
}  // namespace taut::test
