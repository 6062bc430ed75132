// Taut's own factorisation beyond what every backend must do (sparse_cholesky_test.cpp): against
// dense matrices.

#include "taut/linalg/block_cholesky.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "linalg/random_matrix.h"
#include "linalg/spring_grid.h"
#include "taut/base/flush_subnormals.h"
#include "taut/base/parallel.h"

namespace taut::test {
namespace {

class BlockFactor : public testing::TestWithParam<CholeskyPrecision> {
 protected:
  double tolerance() const {
    return GetParam() == CholeskyPrecision::double_precision ? 1e-11 : 3e-5;
  }

  void expect_solves(const BlockCsr& a) {
    ASSERT_TRUE(cholesky_.analyze(a).ok());
    expect_refactorises(a);
  }
  void expect_refactorises(const BlockCsr& a) {
    const Status status = cholesky_.factorize(a);
    ASSERT_TRUE(status.ok()) << status.message;
    const std::vector<double> b = random_.vector(a.dofs());
    std::vector<double> x(b.size(), std::numeric_limits<double>::quiet_NaN());
    ASSERT_TRUE(cholesky_.solve(b, x).ok());
    if (a.dofs() > 0) {
      EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), tolerance());
    }
  }

  Random random_{1};
  BlockCholesky cholesky_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Precisions, BlockFactor,
                         testing::Values(CholeskyPrecision::double_precision,
                                         CholeskyPrecision::single_precision),
                         [](const auto& p) {
                           return p.param == CholeskyPrecision::double_precision ? "double"
                                                                                 : "single";
                         });

TEST_P(BlockFactor, MixedDims) {
  for (const Index nodes : {1, 2, 7, 40, 150})
    for (int trial = 0; trial < 3; ++trial)
      expect_solves(random_spd(
          random_, make_pattern(random_graph(random_, nodes, 3, 40), random_dims(random_, nodes)),
          1e-2));
}

TEST_P(BlockFactor, ScalarBlocks) {
  expect_solves(random_spd(random_, make_pattern(random_graph(random_, 400, 3, 200), 1), 1e-2));
}

TEST_P(BlockFactor, DenseMatrix) {
  std::vector<std::vector<Index>> all(60);
  for (auto& row : all)
    for (Index j = 0; j < 60; ++j) row.push_back(j);
  expect_solves(random_spd(random_, make_pattern(all, 3), 1e-2));
}

TEST_P(BlockFactor, DiagonalMatrix) {
  expect_solves(random_spd(
      random_, make_pattern(std::vector<std::vector<Index>>(30), random_dims(random_, 30))));
}

TEST_P(BlockFactor, SeveralComponents) {
  std::vector<std::vector<Index>> columns;
  for (const Index size : {1, 30, 2, 0, 75, 1}) {
    const Index first = static_cast<Index>(columns.size());
    for (auto row :
         size > 0 ? random_graph(random_, size, 3, 20) : std::vector<std::vector<Index>>{}) {
      for (Index& j : row) j += first;
      columns.push_back(std::move(row));
    }
  }
  expect_solves(random_spd(random_, make_pattern(columns, 3), 1e-2));
}

// The analysis of the full pattern serves matrices with fewer unknowns at some nodes, and with
// blocks missing.
TEST_P(BlockFactor, AnalysisSurvivesFewerUnknowns) {
  const auto graph = random_graph(random_, 120, 3, 30);
  const BlockCsr full = random_spd(random_, make_pattern(graph, 3), 1e-2);
  ASSERT_TRUE(cholesky_.analyze(full).ok());
  for (int trial = 0; trial < 4; ++trial) {
    auto fewer = graph;
    for (std::size_t i = 0; i + 1 < fewer.size(); i += 9) {  // the link between i and i+1 is gone
      std::erase(fewer[i], static_cast<Index>(i + 1));
      std::erase(fewer[i + 1], static_cast<Index>(i));
    }
    expect_refactorises(random_spd(
        random_, make_pattern(trial % 2 ? fewer : graph, random_dims(random_, 120)), 1e-2));
  }
  expect_refactorises(full);
}

TEST_P(BlockFactor, RefusesWhatWasNotAnalysed) {
  const auto graph = random_graph(random_, 20, 1, 4);
  ASSERT_TRUE(cholesky_.analyze(random_spd(random_, make_pattern(graph, 2))).ok());
  auto linked = graph;
  linked[0].push_back(19), linked[19].push_back(0);
  for (const BlockCsr& a :
       {random_spd(random_, make_pattern(linked, 2)), random_spd(random_, make_pattern(graph, 3)),
        random_spd(random_, make_pattern(random_graph(random_, 21, 1, 4), 2))}) {
    const Status status = cholesky_.factorize(a);
    EXPECT_EQ(status.outcome, Outcome::breakdown);
    EXPECT_FALSE(status.message.empty());
  }
}

TEST_P(BlockFactor, NamesTheNodeOfABadPivot) {
  BlockCsr a = random_spd(random_, make_pattern(random_graph(random_, 50, 2, 10), 3), 1e-2);
  for_each_entry(a, [](Index row, Index column, double& value) {
    if (row == 40 && column == 40) value = -value;  // node 13
  });
  ASSERT_TRUE(cholesky_.analyze(a).ok());
  const Status status = cholesky_.factorize(a);
  EXPECT_EQ(status.outcome, Outcome::not_positive_definite);
  EXPECT_NE(status.message.find("unknown 40 (node 13)"), std::string::npos) << status.message;
}

BlockCsr beyond_float(Random& random) {
  BlockCsr a = random_spd(random, make_pattern(random_graph(random, 30, 2, 10), 3), 1e-2);
  for (double& value : a.values) value *= 1e200;
  return a;
}

// A matrix so small that what is subtracted from it is subnormal in single precision: taken for
// zero on every thread, whatever the caller's thread does with such numbers, and the caller's way
// is as it was.
TEST(BlockFactorSubnormals, AreZeroOnEveryThread) {
  Random random(8);
  SpringGrid grid(random, 40, 40, 0.3);
  for (double& value : grid.a.values) value *= 1e-36;
  const std::vector<double> b = random.vector(grid.a.dofs());
  const int usual = thread_count();
  std::vector<double> expected;
  for (const int threads : {1, 2, 4})
    for (const bool flushed_before : {false, true}) {
      set_thread_count(threads);
      std::optional<FlushSubnormals> flush;
      if (flushed_before) flush.emplace();
      BlockCholesky factor(CholeskyPrecision::single_precision);
      std::vector<double> x(b.size());
      ASSERT_TRUE(factor.analyze(grid.a).ok());
      ASSERT_TRUE(factor.factorize(grid.a).ok());
      factor.solve_forward(b);
      factor.solve_backward(0.0, x);
      if (expected.empty()) expected = x;
      EXPECT_TRUE(x == expected) << threads << " threads, " << flushed_before;
      volatile float smallest = std::numeric_limits<float>::min(), half = 0.5f;
      EXPECT_EQ(smallest * half == 0.0f, flushed_before);
    }
  set_thread_count(usual);
}

TEST(BlockFactorFallback, OverflowInSinglePrecisionIsReported) {
  Random random(2);
  BlockCholesky cholesky(CholeskyPrecision::single_precision);
  const BlockCsr a = beyond_float(random);
  ASSERT_TRUE(cholesky.analyze(a).ok());
  EXPECT_EQ(cholesky.factorize(a).outcome, Outcome::not_finite);
}

TEST(BlockFactorFallback, AutomaticPrecisionFallsBack) {
  Random random(3);
  BlockCholesky cholesky(CholeskyPrecision::automatic);
  BlockCsr a = beyond_float(random);
  const std::vector<double> b = random.vector(a.dofs());
  std::vector<double> x(b.size());
  ASSERT_TRUE(cholesky.analyze(a).ok() && cholesky.factorize(a).ok() && cholesky.solve(b, x).ok());
  EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), 1e-11);
  EXPECT_EQ(cholesky.block_statistics().fallbacks, 1);
  EXPECT_FALSE(cholesky.block_statistics().single_precision);
  for (double& value : a.values) value *= 1e-200;
  ASSERT_TRUE(cholesky.factorize(a).ok() && cholesky.solve(b, x).ok());
  EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), 3e-5);
  EXPECT_EQ(cholesky.block_statistics().fallbacks, 1);
  EXPECT_TRUE(cholesky.block_statistics().single_precision);
}

}  // namespace
}  // namespace taut::test
