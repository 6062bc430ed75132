#include "taut/contact/intersection.h"

#include <algorithm>
#include <array>

#include "taut/base/collect.h"
#include "taut/contact/detection/clear_pairs.h"

namespace taut {

std::vector<Intersection> find_intersections(BroadPhase& broad_phase, std::span<const Vec3> x) {
  constexpr Index chunk = 1024;
  const CollisionSurface& surface = broad_phase.surface();
  broad_phase.refit(x, x, 0.0);
  std::vector<EdgeTriangle> pairs;
  broad_phase.find_edge_triangle(pairs);
  detail::FloatWays positions;
  positions.set(x, x);
  std::vector<Intersection> intersections;
  const auto find = [&](Index begin, Index end, std::vector<Intersection>& found) {
    std::array<detail::SegmentTriangle, chunk> corners{};
    std::array<std::uint8_t, chunk> apart;
    for (Index k = begin; k < end; ++k) {
      const auto [a, b] = surface.edges[pairs[k].edge];
      const Triangle& t = surface.triangles[pairs[k].triangle];
      corners[k - begin] = {a, b, t[0], t[1], t[2]};
    }
    positions.find_apart(corners.data(), end - begin, apart.data());
    for (Index k = begin; k < end; ++k) {
      if (apart[k - begin]) continue;
      const auto [a, b, c, d, e] = corners[k - begin];
      const Meeting meeting = segment_meets_triangle(x[a], x[b], x[c], x[d], x[e]);
      if (meeting.meets) found.push_back({pairs[k].edge, pairs[k].triangle, meeting.touching});
    }
  };
  collect(static_cast<Index>(pairs.size()), chunk, find, intersections);
  std::ranges::sort(intersections);
  return intersections;
}

}  // namespace taut
