#include "taut/contact/ccd.h"

#include <Eigen/Geometry>
#include <array>

#include "taut/base/collect.h"
#include "taut/contact/detection/clear_pairs.h"
#include "taut/contact/detection/separating_planes.h"
#include "taut/contact/proximity.h"

namespace taut {

namespace {

using detail::SeparatingPlanes;
using Corners = const Vec3* [4];

Vec3 mean(const Vec3& start, const Vec3& end, double t) { return (1.0 - t) * start + t * end; }

// What the walk needs of a pair: its closest points at a time, and a normal worth a try when theirs
// fails for rounding.
struct MovingPointTriangle {
  Vec3 ap[2], ab[2], ac[2];

  MovingPointTriangle(const Corners& x0, const Corners& x1)
      : ap{*x0[0] - *x0[1], *x1[0] - *x1[1]},
        ab{*x0[2] - *x0[1], *x1[2] - *x1[1]},
        ac{*x0[3] - *x0[1], *x1[3] - *x1[1]} {}
  PointTriangleProximity closest(double t) const {
    return closest_point_triangle(mean(ap[0], ap[1], t), mean(ab[0], ab[1], t),
                                  mean(ac[0], ac[1], t));
  }
  Vec3 cross(double t) const { return mean(ab[0], ab[1], t).cross(mean(ac[0], ac[1], t)); }
};

struct MovingEdges {
  Vec3 ca[2], ab[2], cd[2];

  MovingEdges(const Corners& x0, const Corners& x1)
      : ca{*x0[0] - *x0[2], *x1[0] - *x1[2]},
        ab{*x0[1] - *x0[0], *x1[1] - *x1[0]},
        cd{*x0[3] - *x0[2], *x1[3] - *x1[2]} {}
  EdgeEdgeProximity closest(double t) const {
    return closest_edge_edge(mean(ca[0], ca[1], t), mean(ab[0], ab[1], t), mean(cd[0], cd[1], t));
  }
  Vec3 cross(double t) const { return mean(ab[0], ab[1], t).cross(mean(cd[0], cd[1], t)); }
};

// For pairs in range that are not far apart.
template <class Pair>
Impact walk(const SeparatingPlanes& planes, const Pair& pair, const CcdOptions& options) {
  const double separation = options.minimum_separation;
  double reached = 0.0;
  for (int check = 0; check < options.max_checks; ++check) {
    const auto closest = pair.closest(reached);
    if (!(closest.distance > separation + options.tolerance)) return {true, reached};
    double next = planes.separated_until(closest.normal, reached, separation);
    if (!(next > reached)) {
      // Rounding has spoilt the normal: that of the face, or of both edges, may still do.
      const Vec3 normal = pair.cross(reached).normalized();
      next = std::max(planes.separated_until(normal, reached, separation),
                      planes.separated_until(-normal, reached, separation));
    }
    if (!(next > reached)) return {true, reached};
    if (next >= 1.0) return {};
    reached = next;
  }
  return {true, reached};
}

template <class Kind, class Pair>
Impact impact_of(const Corners& x0, const Corners& x1, const CcdOptions& options) {
  const SeparatingPlanes planes(Kind{}, x0, x1);
  if (!planes.in_range()) return {true, 0.0};
  if (planes.far_apart(options.minimum_separation)) return {};
  return walk(planes, Pair(x0, x1), options);
}

}  // namespace

Impact vertex_triangle_impact(const Vec3& p0, const Vec3& a0, const Vec3& b0, const Vec3& c0,
                              const Vec3& p1, const Vec3& a1, const Vec3& b1, const Vec3& c1,
                              const CcdOptions& options) {
  return impact_of<SeparatingPlanes::VertexTriangle, MovingPointTriangle>(
      {&p0, &a0, &b0, &c0}, {&p1, &a1, &b1, &c1}, options);
}

Impact edge_edge_impact(const Vec3& a0, const Vec3& b0, const Vec3& c0, const Vec3& d0,
                        const Vec3& a1, const Vec3& b1, const Vec3& c1, const Vec3& d1,
                        const CcdOptions& options) {
  return impact_of<SeparatingPlanes::EdgeEdge, MovingEdges>({&a0, &b0, &c0, &d0},
                                                            {&a1, &b1, &c1, &d1}, options);
}

namespace {

constexpr Index impact_chunk = 512;

// Hits of each chunk go to a list of its own; lists are joined in order. corners_of(k): of pair k.
template <class CornersOf>
void collect_hits(Index pairs, bool edges, std::span<const Vec3> x0, std::span<const Vec3> x1,
                  const CcdOptions& options, const CornersOf& corners_of,
                  std::vector<PairImpact>& hits) {
  const auto decide = edges ? edge_edge_impact : vertex_triangle_impact;
  const auto find = [&](Index begin, Index end, std::vector<PairImpact>& found) {
    std::array<detail::PairCorners, impact_chunk> corners{};
    std::array<std::uint8_t, impact_chunk> clear;
    for (Index k = begin; k < end; ++k) corners[k - begin] = corners_of(k);
    detail::find_clear(corners.data(), end - begin, edges, x0.data(), x1.data(),
                       options.minimum_separation, clear.data());
    for (Index k = begin; k < end; ++k) {
      if (clear[k - begin] & detail::clear_throughout) continue;
      const auto [i, j, l, m] = corners[k - begin];
      const Impact impact = decide(x0[i], x0[j], x0[l], x0[m], x1[i], x1[j], x1[l], x1[m], options);
      if (impact.hit) found.push_back({k, impact.time});
    }
  };
  hits.clear();
  collect(pairs, impact_chunk, find, hits);
}

}  // namespace

void find_impacts(const CollisionSurface& surface, std::span<const Vec3> x0,
                  std::span<const Vec3> x1, std::span<const VertexTriangle> pairs,
                  const CcdOptions& options, std::vector<PairImpact>& hits) {
  const auto corners_of = [&](Index k) {
    const Triangle& t = surface.triangles[pairs[k].triangle];
    return detail::PairCorners{pairs[k].vertex, t[0], t[1], t[2]};
  };
  collect_hits(static_cast<Index>(pairs.size()), false, x0, x1, options, corners_of, hits);
}

void find_impacts(const CollisionSurface& surface, std::span<const Vec3> x0,
                  std::span<const Vec3> x1, std::span<const EdgeEdge> pairs,
                  const CcdOptions& options, std::vector<PairImpact>& hits) {
  const auto corners_of = [&](Index k) {
    const auto [a, b] = surface.edges[pairs[k].first];
    const auto [c, d] = surface.edges[pairs[k].second];
    return detail::PairCorners{a, b, c, d};
  };
  collect_hits(static_cast<Index>(pairs.size()), true, x0, x1, options, corners_of, hits);
}

void find_impacts(std::span<const std::array<Index, 4>> pairs, bool edges, std::span<const Vec3> x0,
                  std::span<const Vec3> x1, const CcdOptions& options,
                  std::vector<PairImpact>& hits) {
  collect_hits(
      static_cast<Index>(pairs.size()), edges, x0, x1, options, [&](Index k) { return pairs[k]; },
      hits);
}

}  // namespace taut
