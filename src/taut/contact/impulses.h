#pragma once
// Rows for pairs that collide during a step, and for nodes that would end inside an analytic solid.
//
// A colliding pair: weights and normal are those of its closest points at the time of impact; its
// points must end at least `gap` apart along that normal, on the side where they were. Where the
// end of the step holds that already (they slid past one another), the closest points at the start
// are taken instead: not past each other from there is more than is needed, but surely enough.

#include <optional>

#include "taut/contact/pair_search.h"
#include "taut/contact/solid_obstacles.h"

namespace taut {

ContactRow impact_row(const CollidingPair& hit, std::span<const Vec3> x0, std::span<const Vec3> x1,
                      double gap, double friction);

ContactRow obstacle_row(Index node, const Obstacle& obstacle, const Vec3& x0);

}  // namespace taut
