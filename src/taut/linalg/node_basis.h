#pragma once
// A basis per node, of some or all directions of its three unknowns: how constraints take unknowns
// out of a matrix of 3x3 blocks that itself stays as it is.
//
//   Qᵀ A Q   Q = blockdiag(Q_i), 3N x n, n = sum of dim; Q_i: the first dim[i] columns of frame[i],
//            orthonormal
//   dim      per node 0 ... 3; empty: Q = I, and A's blocks may have any size
//   frame    per node; not looked at where dim is 3, where Q_i = I

#include <cstdint>
#include <cstring>
#include <span>

#include "taut/base/types.h"

namespace taut {

// Calls f(node) for the nodes whose dim is not 3, in order: mostly few. Eight
// nodes are looked at at once.
template <class Function>
void for_each_projected(std::span<const std::int8_t> dim, Function&& f) {
  constexpr std::uint64_t all_three = 0x0303030303030303;
  const Index nodes = static_cast<Index>(dim.size());
  for (Index i = 0; i < nodes;) {
    std::uint64_t eight = 0;
    if (i + 8 <= nodes) std::memcpy(&eight, dim.data() + i, 8);
    if (eight == all_three) {
      i += 8;
      continue;
    }
    for (const Index end = nodes - i < 8 ? nodes : i + 8; i < end; ++i)
      if (dim[i] != 3) f(i);
  }
}

struct NodeBasis {
  std::span<const std::int8_t> dim;
  std::span<const Mat3> frame;
};

}  // namespace taut
