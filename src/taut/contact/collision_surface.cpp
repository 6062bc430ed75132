#include "taut/contact/collision_surface.h"

#include <algorithm>
#include <cassert>

namespace taut {

std::vector<EdgeVertices> unique_edges(std::span<const Triangle> triangles) {
  std::vector<EdgeVertices> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const Index a = t[k], b = t[(k + 1) % 3];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b)});
    }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

CollisionSurface join_surfaces(std::span<const SurfacePart> parts) {
  CollisionSurface surface;
  Index body = 0;
  for (const SurfacePart& part : parts) {
    for (const Triangle& t : part.triangles) {
      for ([[maybe_unused]] const Index v : t) assert(v >= 0 && v < part.vertices);
      surface.triangles.push_back(
          {t[0] + surface.vertices, t[1] + surface.vertices, t[2] + surface.vertices});
    }
    surface.vertices += part.vertices;
    surface.body.resize(static_cast<std::size_t>(surface.vertices), body++);
    surface.is_solid.resize(static_cast<std::size_t>(surface.vertices), part.is_solid ? 1 : 0);
  }
  surface.edges = unique_edges(surface.triangles);
  return surface;
}

}  // namespace taut
