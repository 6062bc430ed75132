#include "taut/mesh/topology.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <compare>

namespace taut {

namespace {

// One side of a triangle.
struct Side {
  Edge edge;
  Index triangle, opposite;
  auto operator<=>(const Side&) const = default;
};

bool repeats_vertex(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

std::vector<Side> sorted_sides(const TriangleMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    if (repeats_vertex(t)) continue;
    for (int c = 0; c < 3; ++c) {
      const auto [a, b] = std::minmax(t[c], t[(c + 1) % 3]);
      assert(a >= 0 && static_cast<std::size_t>(b) < mesh.positions.size());
      sides.push_back({{a, b}, static_cast<Index>(f), t[(c + 2) % 3]});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

void add_hinges(const Side* side, std::size_t count, Topology& topology) {
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const Side &first = side[k], &second = side[k + 1];
    if (first.opposite == second.opposite)
      ++topology.folded_hinges;
    else
      topology.hinges.push_back(
          {first.edge, {first.opposite, second.opposite}, {first.triangle, second.triangle}});
  }
}

}  // namespace

Topology build_topology(const TriangleMesh& mesh) {
  const std::vector<Side> sides = sorted_sides(mesh);
  Topology topology;
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    const Edge edge = sides[begin].edge;
    while (end < sides.size() && sides[end].edge == edge) ++end;
    topology.edges.push_back(edge);
    if (end - begin == 1) topology.boundary_edges.push_back(edge);
    if (end - begin > 2) topology.non_manifold_edges.push_back(edge);
    add_hinges(&sides[begin], end - begin, topology);
  }
  return topology;
}

double triangle_area(const TriangleMesh& mesh, Index triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3& origin = mesh.positions[t[0]];
  return 0.5 * (mesh.positions[t[1]] - origin).cross(mesh.positions[t[2]] - origin).norm();
}

std::vector<double> vertex_areas(const TriangleMesh& mesh) {
  std::vector<double> area(mesh.positions.size(), 0.0);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const double share = triangle_area(mesh, static_cast<Index>(f)) / 3;
    for (const Index vertex : mesh.triangles[f]) area[vertex] += share;
  }
  return area;
}

}  // namespace taut
