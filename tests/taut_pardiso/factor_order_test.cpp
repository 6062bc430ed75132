// The permutation that PARDISO hands out is that of its factor: eliminating in this order fills as
// much as PARDISO says that it stores.

#include <gtest/gtest.h>

#include "sheet.h"
#include "taut_pardiso/pardiso.h"

namespace taut::test {
namespace {

// Entries of L when unknown order[k] is eliminated k-th (Liu's elimination tree: row k of L is what
// the tree paths from A's row k pass).
double fill_in(const ScalarCsc& lower, std::span<const Index> order) {
  const Index n = static_cast<Index>(order.size());
  std::vector<Index> place(order.size()), parent(order.size(), -1), visited(order.size(), -1);
  for (Index k = 0; k < n; ++k) place[order[k]] = k;
  std::vector<std::vector<Index>> row(order.size());
  for (Index j = 0; j < n; ++j)
    for (Index e = lower.column_start[j]; e < lower.column_start[j + 1]; ++e) {
      const auto [first, second] = std::minmax(place[j], place[lower.row[e]]);
      if (first != second) row[second].push_back(first);
    }
  double entries = n;
  for (Index k = 0; k < n; ++k) {
    visited[k] = k;
    for (Index i : row[k])
      for (; visited[i] != k; i = parent[i]) {
        if (parent[i] == -1) parent[i] = k;
        visited[i] = k;
        entries += 1;
      }
  }
  return entries;
}

TEST(Pardiso, HandsOutTheOrderOfItsFactor) {
  Random random(1);
  const BlockCsr a = sheet(random, 40);
  ScalarCsc lower;
  lower_triangle(a, lower);
  PardisoCholesky pardiso;
  ASSERT_TRUE(pardiso.analyze(a).ok() && pardiso.factorize(a).ok());
  const auto order = pardiso.permutation();
  std::vector<Index> sorted(order.begin(), order.end()), inverse(order.size());
  std::ranges::sort(sorted);
  for (Index k = 0; k < a.dofs(); ++k) {
    ASSERT_EQ(sorted[k], k);
    inverse[order[k]] = k;
  }
  const FactorStatistics statistics = pardiso.statistics();
  const double entries = fill_in(lower, order);
  EXPECT_LE(entries, statistics.nonzeros);
  EXPECT_GE(entries, 0.8 * statistics.nonzeros);  // supernodes store some zeros
  // so this test can tell an order from its inverse
  EXPECT_GE(fill_in(lower, inverse), 2.0 * statistics.nonzeros);
  // Σ |L_k|² >= (Σ |L_k|)² / n; told in whole millions
  EXPECT_GE(statistics.flops + 1e6, entries * entries / a.dofs());
  EXPECT_EQ(statistics.ordering, "metis");
}

}  // namespace
}  // namespace taut::test
