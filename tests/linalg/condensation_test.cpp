// Nodes eliminated before the fronts: which ones, what they leave, and factors that hold them,
// against dense matrices.

#include "taut/linalg/block_cholesky/condensation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "linalg/random_matrix.h"
#include "taut/base/parallel.h"
#include "taut/linalg/block_cholesky.h"
#include "taut/linalg/block_cholesky/elimination_order.h"

namespace taut::test {
namespace {

// Each node of a grid with those at most `reach` rows and columns away in all.
std::vector<std::vector<Index>> grid(Index nu, Index nv, Index reach) {
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(nu * nv));
  for (Index i = 0; i < nu * nv; ++i)
    for (Index j = 0; j < nu * nv; ++j)
      if (i != j && std::abs(i % nu - j % nu) + std::abs(i / nu - j / nu) <= reach)
        columns[i].push_back(j);
  return columns;
}

TEST(Condensation, EverySecondNodeOfAGrid) {
  const AnalyzedGraph all = analyzed_graph(*make_pattern(grid(9, 8, 1), 3));
  const std::vector<Index> condensed = condensed_nodes(all);
  EXPECT_EQ(condensed.size(), 36u);
  for (const Index i : condensed)
    for (Index e = all.graph.start[i]; e < all.graph.start[i + 1]; ++e)
      EXPECT_FALSE(std::ranges::binary_search(condensed, all.graph.neighbour[e]))
          << "two of them share a block";
}

TEST(Condensation, NoneWhereNodesHaveManyNeighboursOrFewerUnknowns) {
  EXPECT_TRUE(condensed_nodes(analyzed_graph(*make_pattern(grid(9, 8, 2), 3))).empty())
      << "twelve neighbours";
  std::vector<Index> dims(72, 3);
  dims[5] = 2;
  EXPECT_TRUE(condensed_nodes(analyzed_graph(*make_pattern(grid(9, 8, 1), dims))).empty());
  EXPECT_TRUE(condensed_nodes(analyzed_graph(*make_pattern(grid(9, 8, 1), 1))).empty())
      << "scalar blocks";
  EXPECT_TRUE(condensed_nodes(analyzed_graph(*make_pattern(std::vector<std::vector<Index>>(20), 3)))
                  .empty())
      << "no neighbours";
}

// What is left has a block where A has one, and between all neighbours of a node that is gone.
TEST(Condensation, LeavesTheGraphOfTheSchurComplement) {
  Random random(1);
  for (const Index nodes : {2, 30, 200}) {
    const auto pattern = make_pattern(random_graph(random, nodes, 1, 12), 3);
    AnalyzedGraph all = analyzed_graph(*pattern);
    std::vector<Index> condensed = condensed_nodes(all);
    ASSERT_FALSE(condensed.empty());
    const CondensedGraph graph = condensed_graph(std::move(all), std::move(condensed));
    std::vector<std::vector<bool>> expected(
        static_cast<std::size_t>(nodes), std::vector<bool>(static_cast<std::size_t>(nodes), false));
    const auto& whole = graph.all.graph;
    for (Index i = 0; i < nodes; ++i)
      for (Index e = whole.start[i]; e < whole.start[i + 1]; ++e)
        expected[i][whole.neighbour[e]] = true;
    for (const Index c : graph.condensed)
      for (Index e = whole.start[c]; e < whole.start[c + 1]; ++e)
        for (Index f = whole.start[c]; f < whole.start[c + 1]; ++f)
          expected[whole.neighbour[e]][whole.neighbour[f]] = true;
    const auto& rest = graph.rest.graph;
    ASSERT_EQ(rest.nodes() + static_cast<Index>(graph.condensed.size()), nodes);
    Index blocks = 0;
    for (Index i = 0; i < rest.nodes(); ++i)
      for (Index e = rest.start[i]; e < rest.start[i + 1]; ++e, ++blocks) {
        const Index row = graph.rest.node[i], column = graph.rest.node[rest.neighbour[e]],
                    k = pattern->find(row, column);
        EXPECT_TRUE(row != column && expected[row][column]);
        EXPECT_EQ(graph.rest.value[e], k < 0 ? -1 : pattern->block_offset[k]);
      }
    Index expected_blocks = 0;
    for (Index i = 0; i < rest.nodes(); ++i)
      for (Index j = 0; j < rest.nodes(); ++j)
        expected_blocks += i != j && expected[graph.rest.node[i]][graph.rest.node[j]];
    EXPECT_EQ(blocks, expected_blocks);
  }
}

// All neighbours of a condensed node are pivots or rows of the supernode it is assigned to, one of
// them a pivot.
TEST(Condensation, AssignsNodesToSupernodesThatHoldTheirNeighbours) {
  Random random(2);
  AnalyzedGraph all = analyzed_graph(*make_pattern(random_graph(random, 150, 1, 12), 3));
  std::vector<Index> condensed = condensed_nodes(all);
  CondensedGraph graph = condensed_graph(std::move(all), std::move(condensed));
  const SupernodeTree tree = make_supernode_tree(
      graph.rest.graph, elimination_order(graph.rest.graph, graph.rest.weight), graph.rest.weight);
  const std::vector<Index> at = assign_condensed(graph, tree);
  ASSERT_EQ(at.size(), graph.condensed.size());
  EXPECT_TRUE(std::ranges::is_sorted(at));
  for (std::size_t c = 0; c < at.size(); ++c) {
    Index pivots = 0;
    const auto& whole = graph.all.graph;
    for (Index e = whole.start[graph.condensed[c]]; e < whole.start[graph.condensed[c] + 1]; ++e) {
      const Index node = static_cast<Index>(
          std::ranges::find(graph.rest.node, graph.all.node[whole.neighbour[e]]) -
          graph.rest.node.begin());
      const Index place =
          static_cast<Index>(std::ranges::find(tree.order, node) - tree.order.begin());
      const bool is_pivot = place >= tree.first[at[c]] && place < tree.first[at[c] + 1];
      EXPECT_TRUE(is_pivot || std::ranges::binary_search(tree.rows(at[c]), place));
      pivots += is_pivot;
    }
    EXPECT_GT(pivots, 0);
  }
}

class CondensedFactor : public testing::TestWithParam<CholeskyPrecision> {
 protected:
  double tolerance() const {
    return GetParam() == CholeskyPrecision::double_precision ? 1e-11 : 3e-5;
  }
  Random random_{3};
  BlockCholesky cholesky_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Precisions, CondensedFactor,
                         testing::Values(CholeskyPrecision::double_precision,
                                         CholeskyPrecision::single_precision),
                         [](const auto& p) {
                           return p.param == CholeskyPrecision::double_precision ? "double"
                                                                                 : "single";
                         });

TEST_P(CondensedFactor, Solves) {
  for (const Index nodes : {2, 9, 60, 300}) {
    const BlockCsr a =
        random_spd(random_, make_pattern(random_graph(random_, nodes, 1, 15), 3), 1e-2);
    ASSERT_TRUE(cholesky_.analyze(a).ok());
    ASSERT_GT(cholesky_.block_statistics().condensed, 0);
    ASSERT_TRUE(cholesky_.factorize(a).ok());
    const std::vector<double> b = random_.vector(a.dofs());
    const Eigen::VectorXd expected = dense(a).llt().solve(as_eigen(b));
    std::vector<double> x(b.size(), std::numeric_limits<double>::quiet_NaN());
    ASSERT_TRUE(cholesky_.solve(b, x).ok());
    EXPECT_LT(relative_difference(x, expected), tolerance());
    EXPECT_NEAR(cholesky_.solve_forward(b), as_eigen(b).dot(expected),
                tolerance() * as_eigen(b).dot(expected));

    // Condensed nodes are first in the factor's order.
    const auto order = cholesky_.permutation();
    std::vector<double> permuted(b.size());
    for (std::size_t k = 0; k < order.size(); ++k)
      permuted[k] = b[static_cast<std::size_t>(order[k])];
    ASSERT_TRUE(cholesky_.solve_permuted(permuted, permuted).ok());
    for (std::size_t k = 0; k < order.size(); ++k)
      EXPECT_EQ(permuted[k], x[static_cast<std::size_t>(order[k])]);
  }
}

// Every node in turn has 0 to 3 unknowns, condensed ones too.
TEST_P(CondensedFactor, SolvesWithFewerUnknowns) {
  const auto graph = random_graph(random_, 60, 1, 15);
  const BlockCsr full = random_spd(random_, make_pattern(graph, 3), 1e-2);
  ASSERT_TRUE(cholesky_.analyze(full).ok());
  ASSERT_GT(cholesky_.block_statistics().condensed, 0);
  for (int trial = 0; trial < 6; ++trial) {
    const BlockCsr a = random_spd(random_, make_pattern(graph, random_dims(random_, 60)), 1e-2);
    ASSERT_TRUE(cholesky_.factorize(a).ok());
    const std::vector<double> b = random_.vector(a.dofs());
    std::vector<double> x(b.size(), std::numeric_limits<double>::quiet_NaN());
    ASSERT_TRUE(cholesky_.solve(b, x).ok());
    EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), tolerance());
  }
}

// Whatever node it is at; and the next matrix is none the worse for it.
TEST_P(CondensedFactor, NamesTheNodeOfABadPivot) {
  const BlockCsr good =
      random_spd(random_, make_pattern(random_graph(random_, 40, 1, 10), 3), 1e-2);
  ASSERT_TRUE(cholesky_.analyze(good).ok());
  ASSERT_GT(cholesky_.block_statistics().condensed, 0);
  for (Index bad = 0; bad < good.dofs(); bad += 7) {
    BlockCsr a = good;
    for_each_entry(a, [&](Index row, Index column, double& value) {
      if (row == bad && column == bad) value = -value;
    });
    Status status = cholesky_.factorize(a);
    EXPECT_EQ(status.outcome, Outcome::not_positive_definite);
    EXPECT_NE(status.message.find("unknown " + std::to_string(bad) + " (node " +
                                  std::to_string(bad / 3) + ")"),
              std::string::npos)
        << status.message;
    for_each_entry(a, [&](Index row, Index column, double& value) {
      if (row == bad && column == bad) value = std::numeric_limits<double>::quiet_NaN();
    });
    status = cholesky_.factorize(a);
    EXPECT_EQ(status.outcome, Outcome::not_finite);
    EXPECT_NE(status.message.find("node " + std::to_string(bad / 3) + ")"), std::string::npos)
        << status.message;
  }
  EXPECT_TRUE(cholesky_.factorize(good).ok());
}

TEST_P(CondensedFactor, SameBitsForAnyNumberOfThreads) {
  const BlockCsr a = random_spd(random_, make_pattern(grid(40, 35, 1), 3), 1e-2);
  const std::vector<double> b = random_.vector(a.dofs());
  ASSERT_TRUE(cholesky_.analyze(a).ok());
  ASSERT_EQ(cholesky_.block_statistics().condensed, 700);
  const int usual = thread_count();
  std::vector<double> x(b.size()), first;
  double norm2 = 0.0;
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    ASSERT_TRUE(cholesky_.factorize(a).ok());
    ASSERT_TRUE(cholesky_.solve(b, x).ok());
    const double now = cholesky_.solve_forward(b);
    if (first.empty()) first = x, norm2 = now;
    EXPECT_EQ(x, first) << threads << " threads";
    EXPECT_EQ(now, norm2) << threads << " threads";
  }
  set_thread_count(usual);
}

}  // namespace
}  // namespace taut::test
