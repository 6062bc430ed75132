#pragma once
// Constraints from the matrix that describes them, S or U of paper Eq. 3 and 8: the frames of U as
// they are, or such as span the range of S.

#include <string>

#include "taut/constraint/constraint_set.h"
#include "taut/io/matrix_market.h"

namespace taut {

// S: 3N x 3N, else U: 3N x n (n = 3N: whichever it is). Displacements are 0. Throws
// InputError("NAME: ...") when the size is wrong, an entry lies outside the nodes' 3x3 blocks (S)
// or a column in several nodes (U), S is no orthogonal projection, or U's columns are not
// orthonormal (to 1e-9).
ConstraintSet to_constraints(const MatrixMarket& matrix, Index nodes, const std::string& name);

}  // namespace taut
