#include "taut/contact/edge_lengths.h"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

double length(const EdgeVertices& edge, std::span<const Vec3> x) {
  return (x[edge[1]] - x[edge[0]]).norm();
}
bool is_cloth(const CollisionSurface& surface, std::size_t e) {
  return !surface.is_solid[surface.edges[e][0]];
}

}  // namespace

std::vector<LengthRange> length_ranges(const CollisionSurface& surface, std::span<const Vec3> x,
                                       std::span<const double> rest, double slack) {
  std::vector<LengthRange> ranges;
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const auto [shorter, longer] = std::minmax({length(surface.edges[e], x), rest[e]});
    ranges.push_back({(1 - slack) * shorter, (1 + slack) * longer});
  }
  return ranges;
}

void project_lengths(const CollisionSurface& surface, std::span<const LengthRange> ranges,
                     std::span<const std::uint8_t> held, std::span<Vec3> x, int iterations) {
  for (int k = 0; k < iterations; ++k)
    for (std::size_t e = 0; e < surface.edges.size(); ++e) {
      const auto [a, b] = surface.edges[e];
      const int free = !held[a] + !held[b];
      if (free == 0) continue;
      const Vec3 d = x[b] - x[a];
      const double now = d.norm(), wanted = std::clamp(now, ranges[e].least, ranges[e].most);
      if (now == wanted || now == 0.0) continue;
      const Vec3 change = ((wanted - now) / (free * now)) * d;
      if (!held[a]) x[a] -= change;
      if (!held[b]) x[b] += change;
    }
}

double worst_stretch(const CollisionSurface& surface, std::span<const double> rest,
                     std::span<const Vec3> x) {
  double worst = 0.0;
  for (std::size_t e = 0; e < surface.edges.size(); ++e)
    if (is_cloth(surface, e) && rest[e] > 0.0)
      worst = std::max(worst, std::abs(length(surface.edges[e], x) / rest[e] - 1));
  return worst;
}

double worst_excess(const CollisionSurface& surface, std::span<const LengthRange> ranges,
                    std::span<const Vec3> x) {
  double worst = 0.0;
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    if (!is_cloth(surface, e) || ranges[e].least <= 0.0) continue;
    const double now = length(surface.edges[e], x);
    worst = std::max({worst, now / ranges[e].most - 1, 1 - now / ranges[e].least});
  }
  return worst;
}

}  // namespace taut
