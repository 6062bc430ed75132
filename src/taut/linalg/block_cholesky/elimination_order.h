#pragma once
// The order of elimination: of several nested dissections the one whose factor takes the fewest
// flops, counted. METIS's separators depend much on how unequal the parts may be: on square grids
// its default costs up to half as much again as the best of these. Done once per topology.

#include <span>
#include <vector>

#include "taut/linalg/node_ordering.h"

namespace taut {

// weight: unknowns of each node.
std::vector<Index> elimination_order(const NodeGraph& graph, std::span<const Index> weight);

}  // namespace taut
