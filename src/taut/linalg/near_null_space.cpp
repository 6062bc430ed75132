#include "taut/linalg/near_null_space.h"

#include <cmath>

namespace taut {

NearNullSpace rigid_motions(Index nodes, std::span<const double> positions) {
  NearNullSpace space;
  space.modes = positions.empty() ? 3 : 6;
  space.values.assign(static_cast<std::size_t>(3 * nodes) * space.modes, 0.0);
  const auto position = [&](Index i) {
    return Eigen::Map<const Vec3>(&positions[3 * static_cast<std::size_t>(i)]);
  };
  Vec3 centre = Vec3::Zero();
  double square = 0.0;
  if (space.modes == 6 && nodes > 0) {
    for (Index i = 0; i < nodes; ++i) centre += position(i) / nodes;
    for (Index i = 0; i < nodes; ++i) square += (position(i) - centre).squaredNorm() / nodes;
  }
  const double scale = square > 0.0 ? 1.0 / std::sqrt(square) : 0.0;
  for (Index i = 0; i < nodes; ++i) {
    double* row = &space.values[static_cast<std::size_t>(3 * i) * space.modes];
    for (Index c = 0; c < 3; ++c) row[c * space.modes + c] = 1.0;
    if (space.modes == 3) continue;
    const Vec3 d = scale * (position(i) - centre);
    // The rotation about axis a moves the node by a x d.
    row[0 * 6 + 4] = d.z(), row[0 * 6 + 5] = -d.y();
    row[1 * 6 + 3] = -d.z(), row[1 * 6 + 5] = d.x();
    row[2 * 6 + 3] = d.y(), row[2 * 6 + 4] = -d.x();
  }
  return space;
}

}  // namespace taut
