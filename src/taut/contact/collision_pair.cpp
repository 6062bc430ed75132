#include "taut/contact/collision_pair.h"

#include "taut/contact/proximity.h"

namespace taut {

CollisionPair pair_of(const CollisionSurface& surface, const VertexTriangle& pair) {
  const Triangle& t = surface.triangles[pair.triangle];
  return {{pair.vertex, t[0], t[1], t[2]}, false};
}

CollisionPair pair_of(const CollisionSurface& surface, const EdgeEdge& pair) {
  const EdgeVertices &a = surface.edges[pair.first], &b = surface.edges[pair.second];
  return {{a[0], a[1], b[0], b[1]}, true};
}

PairProximity closest(const CollisionPair& pair, std::span<const Vec3> x) {
  const auto& n = pair.node;
  PairProximity result;
  if (pair.edges) {
    const EdgeEdgeProximity p = closest_edge_edge(x[n[0]], x[n[1]], x[n[2]], x[n[3]]);
    result.weight = {1.0 - p.s, p.s, p.t - 1.0, -p.t};
    result.normal = p.normal;
    result.distance = p.distance;
    result.inside = p.s > 0.0 && p.s < 1.0 && p.t > 0.0 && p.t < 1.0;
  } else {
    const PointTriangleProximity p = closest_point_triangle(x[n[0]], x[n[1]], x[n[2]], x[n[3]]);
    result.weight = {1.0, -p.weights[0], -p.weights[1], -p.weights[2]};
    result.normal = p.normal;
    result.distance = p.distance;
  }
  return result;
}

Impact impact(const CollisionPair& pair, std::span<const Vec3> x0, std::span<const Vec3> x1,
              const CcdOptions& options) {
  const auto& n = pair.node;
  const auto decide = pair.edges ? edge_edge_impact : vertex_triangle_impact;
  return decide(x0[n[0]], x0[n[1]], x0[n[2]], x0[n[3]], x1[n[0]], x1[n[1]], x1[n[2]], x1[n[3]],
                options);
}

}  // namespace taut
