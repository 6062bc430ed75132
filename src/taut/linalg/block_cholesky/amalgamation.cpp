#include "taut/linalg/block_cholesky/amalgamation.h"

#include <algorithm>

#include "taut/linalg/block_cholesky/elimination_tree.h"

namespace taut {

namespace {

// Work of a front in units of a SIMD multiply-add of its products (measured on AVX2 in single
// precision; results depend on it little).
double work(double columns, double rows) {
  constexpr double per_panel_entry = 6.0;   // zeroed, assembled, written, and read by every solve
  constexpr double per_update_entry = 4.0;  // written, read, added
  constexpr double per_front = 8000.0;
  const double multiply_adds =
      columns * columns * columns / 6.0 + columns * rows * (columns + rows) / 2.0;
  return multiply_adds + 0.5 * per_panel_entry * columns * (columns + 2.0 * rows) +
         0.5 * per_update_entry * rows * rows + per_front;
}

// A group while groups are merged: its columns are a list of ranges of fundamental supernodes.
struct Group {
  Index begin = 0, end = 0;  // its own columns
  Index parent = -1;
  double columns = 0.0, rows = 0.0;  // unknowns: pivots, and below them
  // children whose columns come before its own: a list through `next_merged`
  Index last_merged = -1;
  Index next_merged = -1;
  Index merged_into = -1;
};

std::vector<Group> fundamental_groups(std::span<const Index> parent, std::span<const Index> count,
                                      std::span<const Index> weight) {
  const Index n = static_cast<Index>(parent.size());
  std::vector<Group> groups;
  std::vector<Index> group_of(parent.size());
  for (Index j = 0; j < n; ++j) {
    const bool continues = j > 0 && parent[j - 1] == j && count[j - 1] == count[j] + weight[j - 1];
    if (!continues) groups.push_back({.begin = j});
    Group& g = groups.back();
    g.end = j + 1;
    g.columns += weight[j];
    g.rows = count[j] - weight[j];
    group_of[j] = static_cast<Index>(groups.size()) - 1;
  }
  for (Group& g : groups) {
    const Index p = parent[g.end - 1];
    g.parent = p < 0 ? -1 : group_of[p];
  }
  return groups;
}

void merge_into_parents(std::vector<Group>& groups) {
  // Children come before parents, so a group is complete when it is looked at; a parent takes its
  // children from the last (which borders on it) to the first.
  const Index n = static_cast<Index>(groups.size());
  std::vector<Index> first_child(groups.size(), -1), next_sibling(groups.size(), -1);
  for (Index g = 0; g < n; ++g) {
    Group& p = groups[g];
    for (Index c = first_child[g]; c != -1; c = next_sibling[c]) {
      Group& child = groups[c];
      if (work(child.columns + p.columns, p.rows) >=
          work(child.columns, child.rows) + work(p.columns, p.rows))
        continue;
      p.columns += child.columns;
      child.merged_into = g;
      child.next_merged = p.last_merged;
      p.last_merged = c;
    }
    if (p.parent >= 0) next_sibling[g] = first_child[p.parent], first_child[p.parent] = g;
  }
}

Index representative(const std::vector<Group>& groups, Index g) {
  while (g >= 0 && groups[g].merged_into >= 0) g = groups[g].merged_into;
  return g;
}

// All columns of a group: those of what was merged into it, depth first, then its own.
void append_columns(const std::vector<Group>& groups, Index g, std::vector<Index>& order) {
  std::vector<Index> stack{g}, reversed;
  while (!stack.empty()) {
    const Group& group = groups[stack.back()];
    stack.pop_back();
    for (Index j = group.end - 1; j >= group.begin; --j) reversed.push_back(j);
    for (Index c = group.last_merged; c != -1; c = groups[c].next_merged) stack.push_back(c);
  }
  order.insert(order.end(), reversed.rbegin(), reversed.rend());
}

}  // namespace

ColumnGroups group_columns(std::span<const Index> parent, std::span<const Index> count,
                           std::span<const Index> weight) {
  std::vector<Group> groups = fundamental_groups(parent, count, weight);
  merge_into_parents(groups);

  std::vector<Index> kept, number(groups.size(), -1), kept_parent;
  for (Index g = 0; g < static_cast<Index>(groups.size()); ++g)
    if (groups[g].merged_into < 0) number[g] = static_cast<Index>(kept.size()), kept.push_back(g);
  for (const Index g : kept) {
    const Index p = representative(groups, groups[g].parent);
    kept_parent.push_back(p < 0 ? -1 : number[p]);
  }
  const std::vector<Index> post = postorder(kept_parent), place = inverse_permutation(post);
  ColumnGroups result;
  result.order.reserve(parent.size());
  for (const Index k : post) {
    result.first.push_back(static_cast<Index>(result.order.size()));
    append_columns(groups, kept[k], result.order);
    result.parent.push_back(kept_parent[k] < 0 ? -1 : place[kept_parent[k]]);
  }
  result.first.push_back(static_cast<Index>(result.order.size()));
  return result;
}

}  // namespace taut
