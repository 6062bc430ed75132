#pragma once
// A closed tube of `around` x `along` nodes, its axis the z axis: node (i, j), i < around, j <
// along, has index j * around + i and stands at
//
//   (r cos φ, r sin φ, height (j/(along-1) - 1/2)),   φ = 2π i / around      m
//
// v runs along the axis. Triangles as of a grid (mesh/grid.h), without a seam.

#include "taut/mesh/triangle_mesh.h"

namespace taut {

struct TubeShape {
  Index around = 3, along = 2;  // nodes, at least 3 and 2
  double radius = 0.1, height = 1.0;
  Index node_count() const { return around * along; }
  bool operator==(const TubeShape&) const = default;
};

TriangleMesh make_tube(const TubeShape& shape);

}  // namespace taut
