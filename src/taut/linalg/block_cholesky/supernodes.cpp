#include "taut/linalg/block_cholesky/supernodes.h"

#include <algorithm>

#include "taut/linalg/block_cholesky/amalgamation.h"
#include "taut/linalg/block_cholesky/elimination_tree.h"
#include "taut/linalg/block_cholesky/pivot_order.h"

namespace taut {

namespace {

std::vector<Index> composed(std::span<const Index> outer, std::span<const Index> inner) {
  std::vector<Index> result(inner.size());
  for (std::size_t k = 0; k < inner.size(); ++k) result[k] = outer[inner[k]];
  return result;
}

void count_factor(std::span<const Index> count, std::span<const Index> weight,
                  SupernodeTree& tree) {
  for (std::size_t j = 0; j < count.size(); ++j)
    for (Index r = 0; r < weight[j]; ++r) {
      const double entries = count[j] - r;
      tree.factor_entries += entries;
      tree.factor_flops += entries * entries;
    }
}

// Rows below the pivots: those of A in the pivots' columns and those of the children.
void find_rows(const NodeGraph& graph, SupernodeTree& tree) {
  std::vector<Index> marked(tree.order.size(), -1), first_child(tree.parent.size(), -1),
      next_sibling(tree.parent.size(), -1);
  tree.row_start.assign(1, 0);
  for (Index s = 0; s < tree.supernodes(); ++s) {
    const Index end = tree.first[s + 1];
    const auto begin_row = tree.row.size();
    const auto add = [&](Index k) {
      if (k < end || marked[k] == s) return;
      marked[k] = s;
      tree.row.push_back(k);
    };
    for (Index k = tree.first[s]; k < end; ++k)
      for (Index e = graph.start[k]; e < graph.start[k + 1]; ++e) add(graph.neighbour[e]);
    for (Index c = first_child[s]; c != -1; c = next_sibling[c])
      for (Offset r = tree.row_start[c]; r < tree.row_start[c + 1]; ++r)
        add(tree.row[static_cast<std::size_t>(r)]);
    std::sort(tree.row.begin() + static_cast<std::ptrdiff_t>(begin_row), tree.row.end());
    tree.row_start.push_back(static_cast<Offset>(tree.row.size()));
    if (const Index p = tree.parent[s]; p >= 0)
      next_sibling[s] = first_child[p], first_child[p] = s;
  }
}

void move_pivots(std::span<const Index> place, SupernodeTree& tree) {
  const std::vector<Index> order = tree.order;
  for (std::size_t k = 0; k < order.size(); ++k) tree.order[place[k]] = order[k];
  for (Index s = 0; s < tree.supernodes(); ++s) {
    const std::span<Index> rows{tree.row.data() + tree.row_start[s],
                                tree.row.data() + tree.row_start[s + 1]};
    for (Index& k : rows) k = place[k];
    std::ranges::sort(rows);
  }
}

}  // namespace

SupernodeTree make_supernode_tree(const NodeGraph& graph, std::vector<Index> order,
                                  std::span<const Index> weight) {
  SupernodeTree tree;
  // Number the nodes in a postorder of their elimination tree: the same fill-in,
  // and subtrees in one piece.
  order = composed(order, postorder(elimination_tree(renumbered(graph, order))));
  const NodeGraph ordered = renumbered(graph, order);
  const std::vector<Index> ordered_weight = composed(weight, order);
  const std::vector<Index> parent = elimination_tree(ordered);
  const std::vector<Index> count =
      column_counts(ordered, parent, postorder(parent), ordered_weight);
  count_factor(count, ordered_weight, tree);

  ColumnGroups groups = group_columns(parent, count, ordered_weight);
  tree.order = composed(order, groups.order);
  tree.first = std::move(groups.first);
  tree.parent = std::move(groups.parent);
  find_rows(renumbered(graph, tree.order), tree);
  move_pivots(pivot_places(tree), tree);
  return tree;
}

}  // namespace taut
