#pragma once
// The graph that was analysed: the nodes of A that have unknowns, and which of them share a block.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "taut/linalg/block_csr.h"
#include "taut/linalg/node_ordering.h"
#include "taut/linalg/parallelogram.h"

namespace taut {

struct AnalyzedGraph {
  // of the nodes with unknowns, numbered in A's order; neighbours ascending
  NodeGraph graph;
  // per neighbour: the first column of its block in the node's row of A ...
  std::vector<Index> value;
  std::vector<Index> diagonal;  // ... and per node of its diagonal block
  std::vector<Index> node;      // the number of each in A
  std::vector<Index> weight;    // its unknowns, at least 1
  Index rows = 0;               // nodes of A

  // Empty if a matrix of this pattern can be factorised with this analysis: the same nodes with at
  // most as many unknowns, blocks only where there were blocks. Else what is wrong.
  std::string mismatch(const BlockPattern& pattern) const;
};

// mask: one byte per block of the pattern, 0 for blocks that are left out; empty: all are in.
// Diagonal blocks always are.
AnalyzedGraph analyzed_graph(const BlockPattern& pattern, std::span<const std::uint8_t> mask = {});

// The blocks of the pattern that are left out, row by row: the first column of each in its
// row of A. In a row, those that something can stand in for (linalg/parallelogram.h) come
// last, from row_split on.
struct UnanalyzedBlocks {
  std::vector<Index> row_start, row_split, value;
  std::span<const Index> row(Index i, bool without_replaced) const {
    return {value.data() + row_start[i],
            value.data() + (without_replaced ? row_split[i] : row_start[i + 1])};
  }
};
UnanalyzedBlocks unanalyzed_blocks(const BlockPattern& pattern, std::span<const std::uint8_t> mask,
                                   std::span<const Parallelogram> replaceable);

}  // namespace taut
