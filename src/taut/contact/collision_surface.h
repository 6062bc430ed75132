#pragma once
// Everything that may collide, as one triangle surface: cloths and solids' meshes, joined.
//
//   vertices    how many; positions are passed beside the surface, one Vec3 (m) a vertex
//   triangles   three vertices each
//   edges       two vertices a < b each, unique, sorted by (a, b)
//   body        per vertex: which part (cloth or solid) it belongs to, from 0 in the order in which
//               they were joined
//   is_solid    per vertex: 1 where it belongs to a solid, else 0. Pairs solid-solid are nobody's
//               business here
//
// Triangles of a part keep their order and follow those of the parts before; so do vertices.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "taut/mesh/triangle_mesh.h"

namespace taut {

using EdgeVertices = std::array<Index, 2>;

struct CollisionSurface {
  Index vertices = 0;
  std::vector<Triangle> triangles;
  std::vector<EdgeVertices> edges;
  std::vector<Index> body;
  std::vector<std::uint8_t> is_solid;

  Index triangle_count() const { return static_cast<Index>(triangles.size()); }
  Index edge_count() const { return static_cast<Index>(edges.size()); }
};

// One cloth or solid. Its triangles count vertices from 0.
struct SurfacePart {
  Index vertices = 0;
  std::span<const Triangle> triangles;
  bool is_solid = false;
};

// The edges of all triangles, each once, sorted; a side between a vertex and itself is none.
std::vector<EdgeVertices> unique_edges(std::span<const Triangle> triangles);

// Asserts that vertex indices are in range (mesh readers guarantee it).
CollisionSurface join_surfaces(std::span<const SurfacePart> parts);

}  // namespace taut
