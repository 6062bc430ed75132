#pragma once
// The elimination tree of a symmetric graph and the column counts of its Cholesky factor (Liu 1990,
// SIAM J. Matrix Anal. Appl. 11; Gilbert, Ng & Peyton 1994, same journal 15; Davis 2006, Direct
// Methods for Sparse Linear Systems, sections 4.1 to 4.5).
//
//   parent[j]   the smallest i > j with L(i, j) != 0, or -1 for a root
//   count[j]    sum of weight[i] over the rows i >= j with L(i, j) != 0: with weight = unknowns of
//               a node, the height of a block column
//
// Nodes are numbered in the order of their elimination. Near linear time.

#include <span>
#include <vector>

#include "taut/linalg/node_ordering.h"

namespace taut {

std::vector<Index> elimination_tree(const NodeGraph& graph);

// order[k] = the k-th node such that every subtree is numbered in one piece, children before their
// parent, siblings in ascending order.
std::vector<Index> postorder(std::span<const Index> parent);

std::vector<Index> column_counts(const NodeGraph& graph, std::span<const Index> parent,
                                 std::span<const Index> post, std::span<const Index> weight);

// The graph with node order[k] called k.
NodeGraph renumbered(const NodeGraph& graph, std::span<const Index> order);

// to[order[k]] = k.
std::vector<Index> inverse_permutation(std::span<const Index> order);

}  // namespace taut
