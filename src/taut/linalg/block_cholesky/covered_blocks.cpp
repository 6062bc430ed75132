#include "taut/linalg/block_cholesky/covered_blocks.h"

#include <algorithm>

namespace taut {

std::vector<std::uint8_t> covered_blocks(const BlockPattern& pattern,
                                         std::span<const std::uint8_t> mask,
                                         const CondensedGraph& graph, const SupernodeTree& tree) {
  constexpr Index without_unknowns = -1, is_condensed = -2;
  std::vector<Index> place(static_cast<std::size_t>(pattern.rows()), without_unknowns),
      supernode(tree.order.size());
  for (std::size_t k = 0; k < tree.order.size(); ++k)
    place[graph.rest.node[tree.order[k]]] = static_cast<Index>(k);
  for (const Index i : graph.condensed) place[graph.all.node[i]] = is_condensed;
  for (Index s = 0; s < tree.supernodes(); ++s)
    std::fill(&supernode[tree.first[s]],
              &supernode[tree.first[s]] + (tree.first[s + 1] - tree.first[s]), s);

  std::vector<std::uint8_t> covered(static_cast<std::size_t>(pattern.blocks()), 0);
  for (Index i = 0; i < pattern.rows(); ++i)
    for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k) {
      const auto [first, second] = std::minmax(place[i], place[pattern.column[k]]);
      if (first == is_condensed && second != without_unknowns)
        covered[k] = mask.empty() || mask[k] || i == pattern.column[k];
      if (first < 0) continue;
      const Index s = supernode[first];
      covered[k] = s == supernode[second] || std::ranges::binary_search(tree.rows(s), second);
    }
  return covered;
}

}  // namespace taut
