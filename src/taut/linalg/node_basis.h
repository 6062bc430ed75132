#pragma once
// A basis per node, of some or all directions of its three unknowns: how constraints take unknowns out of a matrix of 3x3 blocks that
// itself stays as it is.
//
//   Qᵀ A Q       Q = blockdiag(Q_i),  Q_i = the first dim[i] columns of frame[i], orthonormal;  3N x n, n = sum of dim
//
//   dim          per node 0 ... 3; empty: Q = I, and A's blocks may have any size
//   frame        per node; not looked at where dim is 3, where Q_i = I

#include <cstdint>
#include <span>

#include "taut/base/types.h"

namespace taut {

struct NodeBasis {
  std::span<const std::int8_t> dim;
  std::span<const Mat3> frame;
};

}  // namespace taut
