#include "taut/contact/intersection.h"

#include <algorithm>

#include "taut/base/collect.h"

namespace taut {

std::vector<Intersection> find_intersections(BroadPhase& broad_phase, std::span<const Vec3> x) {
  constexpr Index chunk = 1024;
  const CollisionSurface& surface = broad_phase.surface();
  broad_phase.refit(x, x, 0.0);
  std::vector<EdgeTriangle> pairs;
  broad_phase.find_edge_triangle(pairs);
  std::vector<Intersection> intersections;
  const auto find = [&](Index begin, Index end, std::vector<Intersection>& found) {
    for (Index k = begin; k < end; ++k) {
      const auto [a, b] = surface.edges[pairs[k].edge];
      const Triangle& t = surface.triangles[pairs[k].triangle];
      const Meeting meeting = segment_meets_triangle(x[a], x[b], x[t[0]], x[t[1]], x[t[2]]);
      if (meeting.meets) found.push_back({pairs[k].edge, pairs[k].triangle, meeting.touching});
    }
  };
  collect(static_cast<Index>(pairs.size()), chunk, find, intersections);
  std::ranges::sort(intersections);
  return intersections;
}

}  // namespace taut
