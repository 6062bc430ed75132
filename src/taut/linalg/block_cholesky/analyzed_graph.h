#pragma once
// The graph that was analysed: the nodes of A that have unknowns, and which of them share a block.

#include <string>
#include <vector>

#include "taut/linalg/block_csr.h"
#include "taut/linalg/node_ordering.h"

namespace taut {

struct AnalyzedGraph {
  NodeGraph graph;            // of the nodes with unknowns, numbered in A's order; neighbours ascending
  std::vector<Index> node;    // the number of each in A
  std::vector<Index> weight;  // its unknowns, at least 1
  Index rows = 0;             // nodes of A

  // Empty if a matrix of this pattern can be factorised with this analysis: the same nodes with at most as many unknowns, blocks only where
  // there were blocks. Else what is wrong.
  std::string mismatch(const BlockPattern& pattern) const;
};

AnalyzedGraph analyzed_graph(const BlockPattern& pattern);

}  // namespace taut
