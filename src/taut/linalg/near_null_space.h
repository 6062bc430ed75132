#pragma once
// The vectors that a matrix hardly resists, which multigrid must represent on its coarse levels:
// for an elastic body its rigid motions.
//
//   values   dofs x modes, row-major: mode m at unknown r is values[r * modes + m]

#include <span>
#include <vector>

#include "taut/base/types.h"

namespace taut {

struct NearNullSpace {
  Index modes = 0;
  std::vector<double> values;
};

// Three translations and, when positions of the nodes are given (m), three linearised rotations
// about their mean, in units of their root mean square distance from it: 3 x nodes unknowns.
NearNullSpace rigid_motions(Index nodes, std::span<const double> positions);

}  // namespace taut
