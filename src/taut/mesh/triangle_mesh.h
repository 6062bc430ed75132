#pragma once
// A triangle mesh: the shape of a cloth or of a solid.
//
//   positions  m, one per vertex
//   triangles  three vertex indices each, from 0, counter-clockwise seen from the front
//   texcoords  empty, or one (u, v) per vertex, no unit
//
// Vertex order is the file's order and is kept through simulation and export.

#include <array>
#include <vector>

#include "taut/base/types.h"

namespace taut {

using Triangle = std::array<Index, 3>;

struct TriangleMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<Vec2> texcoords;
};

}  // namespace taut
