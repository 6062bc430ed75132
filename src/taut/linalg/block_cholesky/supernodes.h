#pragma once
// Supernodes: runs of nodes that are eliminated together as one dense front, and the tree they form
// (Liu 1992, SIAM Review 34, the multifrontal method). How they are chosen:
// docs/design/block-cholesky.md. All of it is about nodes.
//
//   weight[i]           unknowns of node i, at least 1
//   order[k]            the node eliminated as the k-th
//   supernode s         the nodes order[first[s]] ... order[first[s+1]-1]; subtrees are numbered in
//                       one piece
//   parent[s]           > s, or -1
//   row[row_start[s]]   ascending, up to row_start[s+1]: places k in the order, of the nodes below
//                       the pivots of s with an entry of L in them
//   factor_entries      entries of L in the lower triangle, with the diagonal, before amalgamation
//   factor_flops        multiplications and additions, likewise: sum over columns of (entries)²

#include <span>
#include <vector>

#include "taut/linalg/node_ordering.h"

namespace taut {

struct SupernodeTree {
  std::vector<Index> order;
  std::vector<Index> first;  // supernodes + 1
  std::vector<Index> parent;
  std::vector<Offset> row_start;  // supernodes + 1
  std::vector<Index> row;
  double factor_entries = 0.0;
  double factor_flops = 0.0;

  Index supernodes() const { return static_cast<Index>(parent.size()); }
  std::span<const Index> rows(Index s) const {
    return {row.data() + row_start[s], row.data() + row_start[s + 1]};
  }
};

// `order`: a fill-reducing order of the graph's nodes; the result's order is another one with the
// same fill-in but for what amalgamation adds.
SupernodeTree make_supernode_tree(const NodeGraph& graph, std::vector<Index> order,
                                  std::span<const Index> weight);

}  // namespace taut
