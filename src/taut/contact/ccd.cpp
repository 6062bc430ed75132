#include "taut/contact/ccd.h"

#include <Eigen/Geometry>

#include "taut/base/parallel.h"
#include "taut/contact/detection/separating_planes.h"
#include "taut/contact/proximity.h"

namespace taut {

namespace {

Vec3 mean(const Vec3& start, const Vec3& end, double t) { return (1.0 - t) * start + t * end; }

// What the walk needs of a pair: its closest points at a time, and other normals worth a try when theirs fails for rounding.
struct MovingPointTriangle {
  Vec3 ap[2], ab[2], ac[2];

  PointTriangleProximity closest(double t) const {
    return closest_point_triangle(mean(ap[0], ap[1], t), mean(ab[0], ab[1], t), mean(ac[0], ac[1], t));
  }
  Vec3 cross(double t) const { return mean(ab[0], ab[1], t).cross(mean(ac[0], ac[1], t)); }
};

struct MovingEdges {
  Vec3 ca[2], ab[2], cd[2];

  EdgeEdgeProximity closest(double t) const {
    return closest_edge_edge(mean(ca[0], ca[1], t), mean(ab[0], ab[1], t), mean(cd[0], cd[1], t));
  }
  Vec3 cross(double t) const { return mean(ab[0], ab[1], t).cross(mean(cd[0], cd[1], t)); }
};

template <class Pair>
Impact walk(const detail::SeparatingPlanes& planes, const Pair& pair, const CcdOptions& options) {
  const double separation = options.minimum_separation;
  if (!planes.in_range()) return {true, 0.0};
  if (planes.boxes_apart(separation)) return {};
  if (planes.separated_until(planes.between_middles(), 0.0, separation) >= 1.0) return {};
  double reached = 0.0;
  for (int check = 0; check < options.max_checks; ++check) {
    const auto closest = pair.closest(reached);
    if (!(closest.distance > separation + options.tolerance)) return {true, reached};
    double next = planes.separated_until(closest.normal, reached, separation);
    if (!(next > reached)) {
      // Rounding has spoilt the normal: that of the face, or of both edges, may still do.
      const Vec3 normal = pair.cross(reached).normalized();
      next = std::max(planes.separated_until(normal, reached, separation), planes.separated_until(-normal, reached, separation));
    }
    if (!(next > reached)) return {true, reached};
    if (next >= 1.0) return {};
    reached = next;
  }
  return {true, reached};
}

}  // namespace

Impact vertex_triangle_impact(const Vec3& p0, const Vec3& a0, const Vec3& b0, const Vec3& c0, const Vec3& p1, const Vec3& a1,
                              const Vec3& b1, const Vec3& c1, const CcdOptions& options) {
  const Vec3 start[4] = {p0 - a0, p0 - b0, p0 - c0, p0 - c0}, end[4] = {p1 - a1, p1 - b1, p1 - c1, p1 - c1};
  const MovingPointTriangle pair{{start[0], end[0]}, {b0 - a0, b1 - a1}, {c0 - a0, c1 - a1}};
  return walk(detail::SeparatingPlanes(start, end), pair, options);
}

Impact edge_edge_impact(const Vec3& a0, const Vec3& b0, const Vec3& c0, const Vec3& d0, const Vec3& a1, const Vec3& b1, const Vec3& c1,
                        const Vec3& d1, const CcdOptions& options) {
  const Vec3 start[4] = {a0 - c0, a0 - d0, b0 - c0, b0 - d0}, end[4] = {a1 - c1, a1 - d1, b1 - c1, b1 - d1};
  const MovingEdges pair{{start[0], end[0]}, {b0 - a0, b1 - a1}, {d0 - c0, d1 - c1}};
  return walk(detail::SeparatingPlanes(start, end), pair, options);
}

namespace {

constexpr Index impact_chunk = 512;

// hits of each chunk in a list of its own, joined in order.
template <class Test>
void collect_hits(Index pairs, std::vector<PairImpact>& hits, const Test& test) {
  const Index chunks = (pairs + impact_chunk - 1) / impact_chunk;
  std::vector<std::vector<PairImpact>> found(static_cast<std::size_t>(chunks));
  parallel_for(chunks, 1, [&](Index begin, Index end) {
    for (Index c = begin; c < end; ++c)
      for (Index k = c * impact_chunk; k < std::min(pairs, (c + 1) * impact_chunk); ++k)
        if (const Impact impact = test(k); impact.hit) found[c].push_back({k, impact.time});
  });
  hits.clear();
  for (const auto& list : found) hits.insert(hits.end(), list.begin(), list.end());
}

}  // namespace

void find_impacts(const CollisionSurface& surface, std::span<const Vec3> x0, std::span<const Vec3> x1,
                  std::span<const VertexTriangle> pairs, const CcdOptions& options, std::vector<PairImpact>& hits) {
  collect_hits(static_cast<Index>(pairs.size()), hits, [&](Index k) {
    const Index p = pairs[k].vertex;
    const Triangle& t = surface.triangles[pairs[k].triangle];
    return vertex_triangle_impact(x0[p], x0[t[0]], x0[t[1]], x0[t[2]], x1[p], x1[t[0]], x1[t[1]], x1[t[2]], options);
  });
}

void find_impacts(const CollisionSurface& surface, std::span<const Vec3> x0, std::span<const Vec3> x1, std::span<const EdgeEdge> pairs,
                  const CcdOptions& options, std::vector<PairImpact>& hits) {
  collect_hits(static_cast<Index>(pairs.size()), hits, [&](Index k) {
    const EdgeVertices& e = surface.edges[pairs[k].first];
    const EdgeVertices& f = surface.edges[pairs[k].second];
    return edge_edge_impact(x0[e[0]], x0[e[1]], x0[f[0]], x0[f[1]], x1[e[0]], x1[e[1]], x1[f[0]], x1[f[1]], options);
  });
}

}  // namespace taut
