// The order of the pivots inside supernodes: rows of descendants become few runs.

#include "taut/linalg/block_cholesky/pivot_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace taut {
namespace {

// Supernodes of given sizes, the last of which is the others' parent; the others' rows are some of
// its pivots.
SupernodeTree tree_of(const std::vector<Index>& sizes,
                      const std::vector<std::vector<Index>>& rows_in_last) {
  SupernodeTree tree;
  tree.first.push_back(0);
  for (const Index size : sizes) tree.first.push_back(tree.first.back() + size);
  tree.order.resize(static_cast<std::size_t>(tree.first.back()));
  std::iota(tree.order.begin(), tree.order.end(), 0);
  const Index last = static_cast<Index>(sizes.size()) - 1;
  tree.parent.assign(sizes.size(), last);
  tree.parent.back() = -1;
  tree.row_start.push_back(0);
  for (const auto& rows : rows_in_last) {
    for (const Index k : rows) tree.row.push_back(tree.first[static_cast<std::size_t>(last)] + k);
    tree.row_start.push_back(static_cast<Offset>(tree.row.size()));
  }
  tree.row_start.push_back(static_cast<Offset>(tree.row.size()));
  return tree;
}

int runs(const SupernodeTree& tree, Index s, const std::vector<Index>& place) {
  std::vector<Index> rows;
  for (const Index k : tree.rows(s)) rows.push_back(place[static_cast<std::size_t>(k)]);
  std::ranges::sort(rows);
  int count = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) count += i == 0 || rows[i] != rows[i - 1] + 1;
  return count;
}

TEST(PivotOrder, InterleavedRowsBecomeOneRunEach) {
  const SupernodeTree tree = tree_of({1, 1, 6}, {{0, 2, 4}, {1, 3, 5}});
  const std::vector<Index> place = pivot_places(tree);
  EXPECT_EQ(runs(tree, 0, place), 1);
  EXPECT_EQ(runs(tree, 1, place), 1);
}

TEST(PivotOrder, OverlappingRowsOfALineInAnyOrderBecomeOneRunEach) {
  // A separator's nodes in a mixed order: node p is at position[p] on a line, and each descendant
  // touches four neighbours on it.
  const std::vector<Index> position{7, 2, 9, 0, 5, 1, 8, 3, 6, 4};
  std::vector<std::vector<Index>> rows;
  for (Index from = 0; from < 7; ++from) {
    rows.emplace_back();
    for (Index p = 0; p < 10; ++p)
      if (position[static_cast<std::size_t>(p)] >= from &&
          position[static_cast<std::size_t>(p)] < from + 4)
        rows.back().push_back(p);
  }
  const SupernodeTree tree = tree_of({1, 1, 1, 1, 1, 1, 1, 10}, rows);
  const std::vector<Index> place = pivot_places(tree);
  for (Index s = 0; s < 7; ++s) EXPECT_EQ(runs(tree, s, place), 1) << s;
}

TEST(PivotOrder, NodesStayInTheirSupernode) {
  const SupernodeTree tree = tree_of({3, 2, 5}, {{0, 4}, {1, 3, 4}});
  const std::vector<Index> place = pivot_places(tree);
  for (Index s = 0; s < tree.supernodes(); ++s) {
    std::vector<Index> moved(place.begin() + tree.first[s], place.begin() + tree.first[s + 1]),
        expected(moved.size());
    std::ranges::sort(moved);
    std::iota(expected.begin(), expected.end(), tree.first[s]);
    EXPECT_EQ(moved, expected) << s;
  }
}

}  // namespace
}  // namespace taut
