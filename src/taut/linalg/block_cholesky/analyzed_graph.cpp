#include "taut/linalg/block_cholesky/analyzed_graph.h"

#include <fmt/format.h>

namespace taut {

AnalyzedGraph analyzed_graph(const BlockPattern& pattern, std::span<const std::uint8_t> mask) {
  AnalyzedGraph result;
  result.rows = pattern.rows();
  std::vector<Index> number(static_cast<std::size_t>(pattern.rows()), -1);
  for (Index i = 0; i < pattern.rows(); ++i)
    if (pattern.dim(i) > 0) {
      number[i] = static_cast<Index>(result.node.size());
      result.node.push_back(i);
      result.weight.push_back(pattern.dim(i));
      result.diagonal.push_back(pattern.block_offset[pattern.diagonal[i]]);
    }
  result.graph.start.push_back(0);
  for (const Index i : result.node) {
    for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k) {
      const Index j = pattern.column[k];
      if (j == i || number[j] < 0 || (!mask.empty() && !mask[k])) continue;
      result.graph.neighbour.push_back(number[j]);
      result.value.push_back(pattern.block_offset[k]);
    }
    result.graph.start.push_back(static_cast<Index>(result.graph.neighbour.size()));
  }
  return result;
}

UnanalyzedBlocks unanalyzed_blocks(const BlockPattern& pattern, std::span<const std::uint8_t> mask,
                                   std::span<const Parallelogram> replaceable) {
  std::vector<std::uint8_t> is_replaceable(mask.size(), 0);
  for (const Parallelogram& p : replaceable)
    is_replaceable[p.block] = is_replaceable[p.opposite] = 1;
  UnanalyzedBlocks result;
  result.row_start.push_back(0);
  for (Index i = 0; i < pattern.rows(); ++i) {
    for (const std::uint8_t last : {0, 1}) {
      if (last) result.row_split.push_back(static_cast<Index>(result.value.size()));
      for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k)
        if (!mask[k] && k != pattern.diagonal[i] && is_replaceable[k] == last)
          result.value.push_back(pattern.block_offset[k]);
    }
    result.row_start.push_back(static_cast<Index>(result.value.size()));
  }
  return result;
}

std::string AnalyzedGraph::mismatch(const BlockPattern& pattern) const {
  if (pattern.rows() != rows)
    return fmt::format("the matrix has {} nodes, the analysed one had {}", pattern.rows(), rows);
  std::size_t n = 0;  // node[n]: the next analysed node
  for (Index i = 0; i < rows; ++i) {
    const bool analyzed = n < node.size() && node[n] == i;
    if (pattern.dim(i) > (analyzed ? weight[n] : 0))
      return fmt::format("node {} has {} unknowns, in the analysed matrix it had {}", i,
                         pattern.dim(i), analyzed ? weight[n] : 0);
    if (!analyzed) continue;
    Index e = graph.start[n];
    const Index end = graph.start[n + 1];
    for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1] && pattern.dim(i) > 0; ++k) {
      const Index j = pattern.column[k];
      if (j == i || pattern.dim(j) == 0) continue;
      while (e < end && node[graph.neighbour[e]] < j) ++e;
      if (e == end || node[graph.neighbour[e]] != j)
        return fmt::format("there was no block ({}, {}) in the analysed matrix", i, j);
    }
    ++n;
  }
  return {};
}

}  // namespace taut
