#pragma once
// Where the blocks of a triangular factor with A's own pattern are: the symbolic half of the zero
// fill-in preconditioners. Rows are kept in level order, which changes no value
// (docs/design/incomplete-factors.md).
//
//   place        a node's position in level order, from 0; nodes without unknowns have none
//   node[p]      the node at place p; dof[p], dim[p]: its first unknown in A and their number
//   lower        the blocks (i, j) of A with j before i, row after row, columns as places,
//                ascending; source = which block of A's pattern
//   upper        those with j after i, likewise
//   block        rows and columns of every stored block: 1 when no node has more than one unknown,
//                else 3; smaller blocks are padded with zeros (the diagonal with ones), so that one
//                kernel serves all nodes
//
// A pattern that is not symmetric is ordered as if it were.

#include <vector>

#include "taut/linalg/block_csr.h"

namespace taut {

struct TriangularRows {
  std::vector<Index> start;   // places + 1
  std::vector<Index> column;  // places
  std::vector<Index> source;  // into A's pattern
};

struct TriangularLayout {
  std::shared_ptr<const BlockPattern> pattern;
  Index block = 3;
  Index levels = 0;
  std::vector<Index> node, dof, dim;
  TriangularRows lower, upper;

  Index places() const { return static_cast<Index>(node.size()); }
  Offset bytes() const;
};

TriangularLayout triangular_layout(std::shared_ptr<const BlockPattern> pattern, bool with_upper);

// Block k of A's row i as block x block row-major numbers, padded with zeros;
// on the diagonal with ones.
void load_padded(const BlockCsr& a, Index i, Index k, Index block, double* out);

}  // namespace taut
