#pragma once
// Closest points of a point and a triangle, and of two edges.
//
//   point-triangle   |p - q| is least, q = wa a + wb b + wc c, weights >= 0 with sum 1
//   edge-edge        |r - q| is least, r = (1 - s) a + s b, q = (1 - t) c + t d, s and t in [0, 1]
//   distance         m
//   normal           unit vector from q to p (to r), never NaN: orthogonal to the side or the face
//                    that q lies in (to both edges where both points are inner ones), even where
//                    p - q is lost in rounding. At distance 0 the triangle's (b - a) x (c - a), the
//                    edges' (b - a) x (d - c); of shapes that have none, any orthogonal to the side
//
// Finite input is assumed. Triangles and pairs of edges with an angle below 1e-8 count as
// degenerate (as parallel): the closest pair with a side (a corner) is taken, which is off by less
// than 1e-8 of their size. Edges may have no length. Closest points on lines: Ericson, "Real-Time
// Collision Detection" (2005), 5.1; the choice between inner points and sides is made by comparing.

#include <array>

#include "taut/base/types.h"

namespace taut {

struct PointTriangleProximity {
  double distance = 0.0;
  Vec3 normal = Vec3::UnitZ();
  std::array<double, 3> weights{1.0, 0.0, 0.0};
};
PointTriangleProximity closest_point_triangle(const Vec3& p, const Vec3& a, const Vec3& b,
                                              const Vec3& c);
// The same for p - a, b - a, c - a, for those who know differences better than positions.
PointTriangleProximity closest_point_triangle(const Vec3& ap, const Vec3& ab, const Vec3& ac);

struct EdgeEdgeProximity {
  double distance = 0.0;
  Vec3 normal = Vec3::UnitZ();
  double s = 0.0;  // along a b
  double t = 0.0;  // along c d
};
EdgeEdgeProximity closest_edge_edge(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
// The same for a - c, b - a, d - c.
EdgeEdgeProximity closest_edge_edge(const Vec3& ca, const Vec3& ab, const Vec3& cd);

}  // namespace taut
