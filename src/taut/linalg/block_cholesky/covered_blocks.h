#pragma once
// The blocks of a matrix that have a place in the factor of another one, on the same nodes: those of that matrix, and those where its
// elimination fills in, or amalgamation stores zeros. To factorise them too costs nothing but their assembly.
//
//   covered(i, j)   i = j, or with i eliminated before j: j is a pivot of i's supernode or one of its rows

#include <cstdint>
#include <vector>

#include "taut/linalg/block_cholesky/analyzed_graph.h"
#include "taut/linalg/block_cholesky/supernodes.h"

namespace taut {

// One byte per block of the pattern; `analyzed` and `tree` are of a graph of its nodes.
std::vector<std::uint8_t> covered_blocks(const BlockPattern& pattern, const AnalyzedGraph& analyzed, const SupernodeTree& tree);

}  // namespace taut
