#include "taut/linalg/block_cholesky/condensation.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "taut/linalg/block_cholesky/elimination_tree.h"

namespace taut {

namespace {

// A node of d neighbours costs d (d + 1) / 2 products of blocks, and joins d nodes to each other.
constexpr Index most_neighbours = 6;
// At most so many are as good as fewer: the borders of a grid come in turn with what is inside, so
// that there is one pattern throughout.
constexpr Index few_neighbours = 4;
// Of all nodes: with fewer than one in so many, the order of elimination is better left alone.
constexpr Index least_share = 4;

}  // namespace

std::vector<Index> condensed_nodes(const AnalyzedGraph& all) {
  if (std::ranges::any_of(all.weight, [](Index weight) { return weight != 3; })) return {};
  const NodeGraph& graph = all.graph;
  const Index nodes = graph.nodes();
  const auto neighbours = [&](Index i) { return graph.start[i + 1] - graph.start[i]; };
  std::vector<Index> order(static_cast<std::size_t>(nodes));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {},
                           [&](Index i) { return std::max(few_neighbours, neighbours(i)); });

  std::vector<Index> chosen;
  std::vector<std::uint8_t> is_taken(static_cast<std::size_t>(nodes), 0);
  for (const Index i : order) {
    if (neighbours(i) > most_neighbours) break;
    if (is_taken[i] || neighbours(i) == 0) continue;
    chosen.push_back(i);
    for (Index e = graph.start[i]; e < graph.start[i + 1]; ++e) is_taken[graph.neighbour[e]] = 1;
  }
  if (least_share * static_cast<Index>(chosen.size()) < nodes) return {};
  std::ranges::sort(chosen);
  return chosen;
}

CondensedGraph condensed_graph(AnalyzedGraph all, std::vector<Index> condensed) {
  if (condensed.empty()) return {all, {}, all};
  const NodeGraph& graph = all.graph;
  std::vector<Index> number(static_cast<std::size_t>(graph.nodes()), 0);
  for (const Index i : condensed) number[i] = -1;
  AnalyzedGraph rest;
  rest.rows = all.rows;
  for (Index i = 0; i < graph.nodes(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<Index>(rest.node.size());
    rest.node.push_back(all.node[i]);
    rest.weight.push_back(all.weight[i]);
    rest.diagonal.push_back(all.diagonal[i]);
  }

  std::vector<std::pair<Index, Index>> row;  // neighbour, value
  rest.graph.start.push_back(0);
  for (Index i = 0; i < graph.nodes(); ++i) {
    if (number[i] < 0) continue;
    row.clear();
    for (Index e = graph.start[i]; e < graph.start[i + 1]; ++e) {
      const Index j = graph.neighbour[e];
      if (number[j] >= 0) {
        row.push_back({number[j], all.value[e]});
        continue;
      }
      for (Index f = graph.start[j]; f < graph.start[j + 1]; ++f)
        if (graph.neighbour[f] != i) row.push_back({number[graph.neighbour[f]], -1});
    }
    // A's own block, if there is one, before what arises.
    std::ranges::sort(row, [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first < b.first : a.second > b.second;
    });
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k > 0 && row[k].first == row[k - 1].first) continue;
      rest.graph.neighbour.push_back(row[k].first);
      rest.value.push_back(row[k].second);
    }
    rest.graph.start.push_back(static_cast<Index>(rest.graph.neighbour.size()));
  }
  return {std::move(all), std::move(condensed), std::move(rest)};
}

std::vector<Index> assign_condensed(CondensedGraph& graph, const SupernodeTree& tree) {
  const std::vector<Index> place = inverse_permutation(tree.order);
  std::vector<Index> place_of(static_cast<std::size_t>(graph.all.rows), -1);  // of A's nodes
  for (std::size_t i = 0; i < graph.rest.node.size(); ++i) place_of[graph.rest.node[i]] = place[i];

  std::vector<std::pair<Index, Index>> owned;  // supernode, node
  for (const Index i : graph.condensed) {
    Index first = std::numeric_limits<Index>::max();
    for (Index e = graph.all.graph.start[i]; e < graph.all.graph.start[i + 1]; ++e)
      first = std::min(first, place_of[graph.all.node[graph.all.graph.neighbour[e]]]);
    owned.push_back(
        {static_cast<Index>(std::ranges::upper_bound(tree.first, first) - tree.first.begin()) - 1,
         i});
  }
  std::ranges::sort(owned);
  std::vector<Index> owner;
  for (std::size_t k = 0; k < owned.size(); ++k) {
    owner.push_back(owned[k].first);
    graph.condensed[k] = owned[k].second;
  }
  return owner;
}

}  // namespace taut
