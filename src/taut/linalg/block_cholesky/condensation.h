#pragma once
// Nodes that are eliminated before all others, each by itself: no two of them share a block (an
// independent set, greedily the nodes of fewest blocks first; of a square grid every second node).
// Static condensation, block LDLᵀ of the nodes' own columns; why: docs/design/block-cholesky.md.
//
//   C_i, B_ij   the diagonal block of node i, its other blocks
//   G_i         G_i Gᵀ_i = C_i⁻¹: lower triangular inverse factor, transposed
//   U_ij        Gᵀ_i B_ij
//   matrix      A_jk -= Uᵀ_ij U_ik for all j, k that i shares blocks with
//   forward     y_i = Gᵀ_i b_i, b_j -= Uᵀ_ij y_i
//   backward    x_i = G_i (y_i - Σ_j U_ij x_j)
//
// With a basis Q_i (linalg/node_basis.h), G_i is of Qᵀ_i C_i Q_i, U_ij = Gᵀ_i Qᵀ_i B_ij, and the
// solves apply Q_i on the way in and out.

#include <vector>

#include "taut/linalg/block_cholesky/analyzed_graph.h"
#include "taut/linalg/block_cholesky/supernodes.h"

namespace taut {

struct CondensedGraph {
  AnalyzedGraph all;
  std::vector<Index> condensed;  // nodes of that graph
  // of the others, in the same order, with a block wherever one arises. A
  // value of -1: A has none there
  AnalyzedGraph rest;
};

// Which nodes of a graph to eliminate first: all have one to six neighbours. None where some node
// has not three unknowns, or where they would be too few to be worth it.
std::vector<Index> condensed_nodes(const AnalyzedGraph& all);
CondensedGraph condensed_graph(AnalyzedGraph all, std::vector<Index> condensed);
// Sorts graph.condensed by the supernode of the first of each one's neighbours to be eliminated:
// there the solves take it in, as all its neighbours are that supernode's pivots and rows. Returns
// the supernodes. The tree is of graph.rest.
std::vector<Index> assign_condensed(CondensedGraph& graph, const SupernodeTree& tree);

}  // namespace taut
