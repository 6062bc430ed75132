#pragma once
// Two features of the surface that may meet: a vertex and a triangle, or two edges.
//
//   node   vertex, then the triangle's three; or the first edge's two, then the second's
//   r      the point on the first minus that on the second, sum_k weight_k x_k (contact_row.h)

#include "taut/contact/ccd.h"
#include "taut/contact/contact_row.h"

namespace taut {

struct CollisionPair {
  std::array<Index, 4> node{};
  bool edges = false;
};

CollisionPair pair_of(const CollisionSurface& surface, const VertexTriangle& pair);
CollisionPair pair_of(const CollisionSurface& surface, const EdgeEdge& pair);

// The closest points at positions x.
struct PairProximity {
  std::array<double, 4> weight{};
  Vec3 normal = Vec3::UnitZ();  // from the second to the first
  double distance = 0.0;        // m
  // inside both edges: not at an end, where a vertex is already compared with a triangle
  bool inside = true;
};
PairProximity closest(const CollisionPair& pair, std::span<const Vec3> x);

Impact impact(const CollisionPair& pair, std::span<const Vec3> x0, std::span<const Vec3> x1,
              const CcdOptions& options);

}  // namespace taut
