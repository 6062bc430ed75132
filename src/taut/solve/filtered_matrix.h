#pragma once
// The two matrices that keep A's size while constraints come and go (docs/mathematics.md, 3):
//
//   S A S + d (I-S)   symmetric: the pre-filtered form (Tamstorf et al. 2015)          S A + d
//   (I-S)   the paper's Eq. 10
//
// d: a mass per node, see node_scale.h. Without constraints (null) both are A.

#include "taut/constraint/constraint_set.h"
#include "taut/linalg/block_csr.h"

namespace taut {

// Into `filtered`, with the same pattern object as A.
void filter_matrix(const BlockCsr& a, const ConstraintSet* constraints, BlockCsr& filtered);
void filter_rows(const BlockCsr& a, const ConstraintSet* constraints, BlockCsr& filtered);

}  // namespace taut
