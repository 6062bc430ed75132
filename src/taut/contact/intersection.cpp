#include "taut/contact/intersection.h"

#include <algorithm>

#include "taut/base/parallel.h"

namespace taut {

std::vector<Intersection> find_intersections(BroadPhase& broad_phase, std::span<const Vec3> x) {
  constexpr Index chunk = 1024;
  const CollisionSurface& surface = broad_phase.surface();
  broad_phase.refit(x, x, 0.0);
  std::vector<EdgeTriangle> pairs;
  broad_phase.find_edge_triangle(pairs);
  const Index count = static_cast<Index>(pairs.size()), chunks = (count + chunk - 1) / chunk;
  std::vector<std::vector<Intersection>> found(static_cast<std::size_t>(chunks));
  parallel_for(chunks, 1, [&](Index begin, Index end) {
    for (Index c = begin; c < end; ++c)
      for (Index k = c * chunk; k < std::min(count, (c + 1) * chunk); ++k) {
        const auto [a, b] = surface.edges[pairs[k].edge];
        const Triangle& t = surface.triangles[pairs[k].triangle];
        const Meeting meeting = segment_meets_triangle(x[a], x[b], x[t[0]], x[t[1]], x[t[2]]);
        if (meeting.meets) found[c].push_back({pairs[k].edge, pairs[k].triangle, meeting.touching});
      }
  });
  std::vector<Intersection> intersections;
  for (const auto& list : found) intersections.insert(intersections.end(), list.begin(), list.end());
  std::ranges::sort(intersections);
  return intersections;
}

}  // namespace taut
