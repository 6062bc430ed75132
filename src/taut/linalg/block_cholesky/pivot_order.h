#pragma once
// The order of the pivots inside each supernode. Fill-in does not depend on it, but the work of
// adding children to parents does: where the rows of a front are a few long runs of its ancestors'
// rows, they are added as whole vectors, and where they are many short ones, one by one.
//
// For the pivots of one supernode let D(v) be the descendants with a row for node v, each weighing
// w = its number of rows. What order v1 ... vm costs is the weighted number of runs, half the
// length of a tour through ∅, v1, ..., vm with the distance
//
//   |u v| = sum of w over the descendants in exactly one of D(u), D(v)
//
// so a short tour is sought: the node farthest from the tour is inserted where it lengthens it
// least (Rosenkrantz, Stearns & Lewis 1977). Ordering the pivots by such a tour is from Pichon,
// Faverge, Ramet & Roman 2017, SIAM J. Matrix Anal. Appl. 38.

#include <vector>

#include "taut/linalg/block_cholesky/supernodes.h"

namespace taut {

// New places: place[k] is where the node at place k of the tree's order should
// go, in the same supernode.
std::vector<Index> pivot_places(const SupernodeTree& tree);

}  // namespace taut
