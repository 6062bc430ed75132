#include "taut/linalg/block_cholesky/elimination_tree.h"

#include <algorithm>

namespace taut {

std::vector<Index> inverse_permutation(std::span<const Index> order) {
  std::vector<Index> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<Index>(k);
  return place;
}

NodeGraph renumbered(const NodeGraph& graph, std::span<const Index> order) {
  const std::vector<Index> place = inverse_permutation(order);
  NodeGraph result;
  result.start.reserve(graph.start.size());
  result.neighbour.reserve(graph.neighbour.size());
  result.start.push_back(0);
  for (const Index i : order) {
    for (Index e = graph.start[i]; e < graph.start[i + 1]; ++e)
      result.neighbour.push_back(place[graph.neighbour[e]]);
    result.start.push_back(static_cast<Index>(result.neighbour.size()));
  }
  return result;
}

std::vector<Index> elimination_tree(const NodeGraph& graph) {
  const Index n = graph.nodes();
  std::vector<Index> parent(static_cast<std::size_t>(n), -1),
      ancestor(static_cast<std::size_t>(n), -1);
  for (Index j = 0; j < n; ++j)
    for (Index e = graph.start[j]; e < graph.start[j + 1]; ++e)
      for (Index i = graph.neighbour[e]; i != -1 && i < j;) {
        const Index next = ancestor[i];
        ancestor[i] = j;
        if (next == -1) parent[i] = j;
        i = next;
      }
  return parent;
}

std::vector<Index> postorder(std::span<const Index> parent) {
  const Index n = static_cast<Index>(parent.size());
  std::vector<Index> first_child(parent.size(), -1), next_sibling(parent.size(), -1), order, stack;
  order.reserve(parent.size());
  for (Index j = n - 1; j >= 0; --j)
    if (parent[j] != -1) next_sibling[j] = first_child[parent[j]], first_child[parent[j]] = j;
  for (Index root = 0; root < n; ++root) {
    if (parent[root] != -1) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const Index j = stack.back(), child = first_child[j];
      if (child == -1) {
        order.push_back(j);
        stack.pop_back();
      } else {
        first_child[j] = next_sibling[child];
        stack.push_back(child);
      }
    }
  }
  return order;
}

namespace {

// Finds the leaves of the row subtrees: row i's subtree is the path set from the columns j with
// A(i, j) != 0 up to i (Davis 2006, section 4.4).
struct RowSubtrees {
  std::span<const Index> first;  // first descendant of each node in postorder
  std::vector<Index> largest_first, previous_leaf, ancestor;

  // Called for the columns j of row i in postorder. 0: j is no leaf; 1: the first leaf; 2: a
  // further one, and `join` is where its path meets the others.
  int classify(Index i, Index j, Index& join) {
    if (first[j] <= largest_first[i]) return 0;
    largest_first[i] = first[j];
    const Index previous = previous_leaf[i];
    previous_leaf[i] = j;
    if (previous == -1) return 1;
    join = previous;
    while (join != ancestor[join]) join = ancestor[join];
    for (Index s = previous; s != join;) {
      const Index next = ancestor[s];
      ancestor[s] = join;
      s = next;
    }
    return 2;
  }
};

}  // namespace

std::vector<Index> column_counts(const NodeGraph& graph, std::span<const Index> parent,
                                 std::span<const Index> post, std::span<const Index> weight) {
  const std::size_t n = parent.size();
  std::vector<Index> count(n, 0), first(n, -1);
  for (std::size_t k = 0; k < n; ++k) {
    Index j = post[k];
    if (first[j] == -1) count[j] = weight[j];  // a leaf of the tree
    for (; j != -1 && first[j] == -1; j = parent[j]) first[j] = static_cast<Index>(k);
  }
  RowSubtrees rows{first, std::vector<Index>(n, -1), std::vector<Index>(n, -1),
                   std::vector<Index>(n)};
  for (std::size_t i = 0; i < n; ++i) rows.ancestor[i] = static_cast<Index>(i);
  // count becomes what each column has more than its children together.
  for (const Index j : post) {
    if (parent[j] != -1) count[parent[j]] -= weight[j];
    for (Index e = graph.start[j]; e < graph.start[j + 1]; ++e) {
      const Index i = graph.neighbour[e];
      Index join = -1;
      const int kind = i > j ? rows.classify(i, j, join) : 0;
      if (kind >= 1) count[j] += weight[i];
      if (kind == 2) count[join] -= weight[i];
    }
    if (parent[j] != -1) rows.ancestor[j] = parent[j];
  }
  for (std::size_t j = 0; j < n; ++j)
    if (parent[j] != -1) count[parent[j]] += count[j];
  return count;
}

}  // namespace taut
