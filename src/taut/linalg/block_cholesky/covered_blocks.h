#pragma once
// The blocks of a matrix that have a place in the factor of another one, on the same nodes: those
// of that matrix, and those where its elimination fills in, or amalgamation stores zeros. To
// factorise them too costs nothing but their assembly.
//
//   covered(i, j)   i = j, or with i eliminated before j: j is a pivot of i's supernode or one of
//                   its rows; i condensed: they share a block

#include <cstdint>
#include <span>
#include <vector>

#include "taut/linalg/block_cholesky/condensation.h"
#include "taut/linalg/block_cholesky/supernodes.h"

namespace taut {

// One byte per block of the pattern; `graph` and `tree` are of its nodes, with the blocks of `mask`
// (one byte per block; empty: all).
std::vector<std::uint8_t> covered_blocks(const BlockPattern& pattern,
                                         std::span<const std::uint8_t> mask,
                                         const CondensedGraph& graph, const SupernodeTree& tree);

}  // namespace taut
