#include "taut/contact/contour_gradient.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "taut/contact/proximity.h"

namespace taut {

namespace {

constexpr double least_slope = 0.01;  // of E·N against |E|

Vec3 unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

}  // namespace

EdgeFaces::EdgeFaces(const CollisionSurface& surface) {
  std::vector<std::pair<Index, Index>> faces;
  for (const Triangle& t : surface.triangles)
    for (int k = 0; k < 3; ++k) {
      const Index a = t[k], b = t[(k + 1) % 3];
      if (a == b) continue;
      const EdgeVertices edge{std::min(a, b), std::max(a, b)};
      faces.emplace_back(
          static_cast<Index>(std::ranges::lower_bound(surface.edges, edge) - surface.edges.begin()),
          t[(k + 2) % 3]);
    }
  std::ranges::sort(faces);
  first.assign(surface.edges.size() + 1, 0);
  for (const auto& [edge, vertex] : faces) {
    ++first[edge + 1];
    opposite.push_back(vertex);
  }
  for (std::size_t e = 0; e < surface.edges.size(); ++e) first[e + 1] += first[e];
}

ContourEnd contour_end(const CollisionSurface& surface, const EdgeFaces& faces,
                       const Intersection& at, std::span<const Vec3> x) {
  const auto [a, b] = surface.edges[at.edge];
  const Triangle& t = surface.triangles[at.triangle];
  ContourEnd end;
  end.node = {a, b, t[0], t[1], t[2]};
  end.normal = unit_or_zero((x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]));
  const Vec3 e = unit_or_zero(x[b] - x[a]);
  end.height = end.normal.dot(x[a] - x[t[0]]);
  const double other = end.normal.dot(x[b] - x[t[0]]);
  const double s =
      end.height == other ? 0.5 : std::clamp(end.height / (end.height - other), 0.0, 1.0);
  const PointTriangleProximity place =
      closest_point_triangle((1 - s) * x[a] + s * x[b], x[t[0]], x[t[1]], x[t[2]]);
  end.weight = {1 - s, s, -place.weights[0], -place.weights[1], -place.weights[2]};
  const double along = e.dot(end.normal),
               slope = std::copysign(std::max(std::abs(along), least_slope), along);
  for (const Index f : faces.of(at.edge)) {
    const Vec3 inwards = (x[f] - x[a]) - (x[f] - x[a]).dot(e) * e;
    Vec3 r = unit_or_zero(end.normal.cross(e.cross(inwards)));
    if (r.dot(inwards) < 0.0) r = -r;
    end.gradient += r - 2.0 * (e.dot(r) / slope) * end.normal;
  }
  return end;
}

}  // namespace taut
