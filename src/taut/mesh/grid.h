#pragma once
// A rectangular sheet of nu x nv nodes: node (i, j), i < nu along `u`, j < nv along
// `v`, has index j * nu + i.
//
//   position(i, j) = origin + i/(nu-1) * u + j/(nv-1) * v   u, v in m: the sheet's two edges, which
//                                                           need not be orthogonal
//   texcoord(i, j) = (i/(nu-1), j/(nv-1))

#include "taut/mesh/triangle_mesh.h"

namespace taut {

struct GridShape {
  Index nu = 2, nv = 2;  // nodes along u and v, at least 2 each
  Vec3 origin = Vec3::Zero();
  Vec3 u = Vec3::UnitX();
  Vec3 v = Vec3::UnitZ();
  Index node(Index i, Index j) const { return j * nu + i; }
  Index node_count() const { return nu * nv; }
  bool operator==(const GridShape&) const = default;
};

// Nodes as above and two triangles per cell; diagonals alternate from cell to cell so that no
// direction is preferred.
TriangleMesh make_grid(const GridShape& shape);

}  // namespace taut
