#pragma once
// Fill-reducing order of elimination: nested dissection on the graph of nodes, by METIS (Karypis &
// Kumar 1998, SIAM J. Sci. Comput. 20).
//
//   graph     adjacency of n nodes, both directions, no loops: the neighbours of i are
//             neighbour[start[i]] ... neighbour[start[i+1]-1]
//   returns   order[k] = the node that is eliminated as the k-th; a permutation of 0 ... n-1
//
// The nodes of a cloth, not its unknowns, are ordered: a third of the vertices, a ninth of the
// edges. The seed is fixed: the same graph always gets the same order. METIS draws from the C
// library's rand(), which it seeds anew; calls from several threads wait for each other.

#include <vector>

#include "taut/base/types.h"

namespace taut {

struct NodeGraph {
  std::vector<Index> start;  // nodes + 1
  std::vector<Index> neighbour;

  Index nodes() const { return static_cast<Index>(start.size()) - 1; }
};

// How much larger one part of a bisection may be than the other, in
// thousandths; METIS's own choice.
constexpr int default_imbalance = 200;
std::vector<Index> nested_dissection(const NodeGraph& graph, int imbalance = default_imbalance);

}  // namespace taut
