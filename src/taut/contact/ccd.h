#pragma once
// Continuous collision detection: does a vertex meet a triangle, or an edge an edge, while all of
// them move along straight lines, x(t) = (1 - t) x0 + t x1, t in [0, 1]?
//
//   hit     the distance is at most `minimum_separation` (m) at some t. Touching counts, and so
//           does contact at t = 0
//   time    a lower bound of the first such t: at `time` and before, the pair is surely further
//           apart; the only exception is time = 0, where nothing was proved
//
// Conservative: "no hit" is proved, rounding included. What is reported as a hit may be a near
// miss: the pair comes as near as minimum_separation + tolerance, or 2e-15 of its size, or
// max_checks ran out. Coordinates that are not finite are a hit at time 0. Callable from any
// thread; no allocation. Why it cannot miss: docs/mathematics.md, 6, and
// docs/design/collision-detection.md.

#include <array>
#include <span>
#include <vector>

#include "taut/contact/broad_phase.h"

namespace taut {

struct CcdOptions {
  double minimum_separation = 0.0;  // m
  // m: nearer than minimum_separation + tolerance may be called a hit
  double tolerance = 1e-10;
  // planes tried for a pair, at most; a pair that needs more is a hit at the time reached
  int max_checks = 1000;
  bool operator==(const CcdOptions&) const = default;
};

struct Impact {
  bool hit = false;
  double time = 1.0;  // no unit; 1 where nothing was hit
  bool operator==(const Impact&) const = default;
};

Impact vertex_triangle_impact(const Vec3& p0, const Vec3& a0, const Vec3& b0, const Vec3& c0,
                              const Vec3& p1, const Vec3& a1, const Vec3& b1, const Vec3& c1,
                              const CcdOptions& options);
Impact edge_edge_impact(const Vec3& a0, const Vec3& b0, const Vec3& c0, const Vec3& d0,
                        const Vec3& a1, const Vec3& b1, const Vec3& c1, const Vec3& d1,
                        const CcdOptions& options);

// A pair of the list and its time of impact.
struct PairImpact {
  Index pair = 0;  // its place in the list
  double time = 0.0;
  bool operator==(const PairImpact&) const = default;
};

// All hits among the pairs, in the order of the list, the same for any number of threads. x0, x1:
// m, one a vertex. Replaces `hits`.
void find_impacts(const CollisionSurface& surface, std::span<const Vec3> x0,
                  std::span<const Vec3> x1, std::span<const VertexTriangle> pairs,
                  const CcdOptions& options, std::vector<PairImpact>& hits);
void find_impacts(const CollisionSurface& surface, std::span<const Vec3> x0,
                  std::span<const Vec3> x1, std::span<const EdgeEdge> pairs,
                  const CcdOptions& options, std::vector<PairImpact>& hits);
// The same of pairs given by their corners, in the order of the functions above: all of edges, or
// all of a vertex and a triangle.
void find_impacts(std::span<const std::array<Index, 4>> pairs, bool edges, std::span<const Vec3> x0,
                  std::span<const Vec3> x1, const CcdOptions& options,
                  std::vector<PairImpact>& hits);

}  // namespace taut
