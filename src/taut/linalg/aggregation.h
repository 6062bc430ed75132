#pragma once
// Groups of neighbouring nodes for algebraic multigrid (Vaněk, Mandel &
// Brezina 1996, algorithm 5.1):
//
//   1   a node whose neighbours are all free founds a group with them, in the order of the nodes
//   2   a node left over joins the group of its strongest neighbour of those grouped in 1
//   3   what is still left is grouped with its neighbours that are left
//
// No random numbers: the same groups every time.

#include <span>
#include <vector>

#include "taut/base/types.h"

namespace taut {

// A graph by rows; weight: how strongly a neighbour is coupled. A node without neighbours becomes a
// group of its own.
struct WeightedGraph {
  std::vector<Index> start, neighbour;
  std::vector<double> weight;
  Index nodes() const { return static_cast<Index>(start.size()) - 1; }
};

struct Aggregation {
  std::vector<Index> group;  // of each node
  Index groups = 0;
};

Aggregation aggregate(const WeightedGraph& graph);

}  // namespace taut
