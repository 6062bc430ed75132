#include "taut/contact/impulses.h"

#include <algorithm>
#include <array>

namespace taut {

namespace {

ContactRow row_at(const CollidingPair& hit, const PairProximity& proximity, double target,
                  double friction) {
  ContactRow row;
  row.node = hit.pair.node;
  row.weight = proximity.weight;
  row.normal = proximity.normal;
  row.target = target;
  row.friction = friction;
  return row;
}

// The pair's own four positions on the way.
PairProximity closest_at(const CollidingPair& hit, std::span<const Vec3> x0,
                         std::span<const Vec3> x1) {
  std::array<Vec3, 4> x;
  for (std::size_t k = 0; k < 4; ++k)
    x[k] = x0[hit.pair.node[k]] + hit.time * (x1[hit.pair.node[k]] - x0[hit.pair.node[k]]);
  return closest({{0, 1, 2, 3}, hit.pair.edges}, x);
}

}  // namespace

ContactRow impact_row(const CollidingPair& hit, std::span<const Vec3> x0, std::span<const Vec3> x1,
                      double gap, double friction) {
  const ContactRow row = row_at(hit, closest_at(hit, x0, x1), gap, friction);
  if (row.normal.dot(separation(row, x1)) < gap) return row;
  const PairProximity start = closest(hit.pair, x0);
  return row_at(hit, start, std::min(gap, start.distance), friction);
}

ContactRow obstacle_row(Index node, const Obstacle& obstacle, const Vec3& x0) {
  ContactRow row;
  row.node[0] = node;
  row.weight[0] = 1.0;
  row.normal = obstacle.normal;
  row.target = obstacle.offset;
  row.friction = obstacle.friction;
  row.carried = obstacle.carried - x0;
  return row;
}

}  // namespace taut
