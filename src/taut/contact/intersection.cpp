#include "taut/contact/intersection.h"

#include <algorithm>
#include <array>

#include "taut/contact/detection/clear_pairs.h"

namespace taut {

std::vector<Intersection> find_intersections(BroadPhase& broad_phase, std::span<const Vec3> x) {
  constexpr Index batch = 1024;
  const CollisionSurface& surface = broad_phase.surface();
  broad_phase.refit(x, x, 0.0);
  detail::FloatWays positions;
  positions.set(x, x);
  std::vector<std::vector<Intersection>> found(static_cast<std::size_t>(broad_phase.edge_parts()));
  broad_phase.for_edge_triangle([&](Index part, std::span<const EdgeTriangle> all) {
    std::array<detail::SegmentTriangle, batch> corners{};
    std::array<std::uint8_t, batch> apart{};
    for (; !all.empty(); all = all.subspan(std::min<std::size_t>(batch, all.size()))) {
      const auto pairs = all.first(std::min<std::size_t>(batch, all.size()));
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        const auto [a, b] = surface.edges[pairs[k].edge];
        const Triangle& t = surface.triangles[pairs[k].triangle];
        corners[k] = {a, b, t[0], t[1], t[2]};
      }
      positions.find_apart(corners.data(), static_cast<Index>(pairs.size()), apart.data());
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        if (apart[k]) continue;
        const auto [a, b, c, d, e] = corners[k];
        const Meeting meeting = segment_meets_triangle(x[a], x[b], x[c], x[d], x[e]);
        if (meeting.meets)
          found[static_cast<std::size_t>(part)].push_back(
              {pairs[k].edge, pairs[k].triangle, meeting.touching});
      }
    }
  });
  std::vector<Intersection> intersections;
  for (const auto& list : found)
    intersections.insert(intersections.end(), list.begin(), list.end());
  std::ranges::sort(intersections);
  return intersections;
}

}  // namespace taut
