#include "taut/mesh/grid.h"

#include <cassert>

#include "taut/mesh/split_quad.h"

namespace taut {

TriangleMesh make_grid(const GridShape& shape) {
  assert(shape.nu >= 2 && shape.nv >= 2);
  TriangleMesh mesh;
  mesh.positions.reserve(static_cast<std::size_t>(shape.node_count()));
  for (Index j = 0; j < shape.nv; ++j)
    for (Index i = 0; i < shape.nu; ++i) {
      const double s = double(i) / (shape.nu - 1), t = double(j) / (shape.nv - 1);
      mesh.positions.push_back(shape.origin + s * shape.u + t * shape.v);
      mesh.texcoords.emplace_back(s, t);
    }
  for (Index j = 0; j + 1 < shape.nv; ++j)
    for (Index i = 0; i + 1 < shape.nu; ++i) {
      const Index a = shape.node(i, j), b = shape.node(i + 1, j), c = shape.node(i + 1, j + 1),
                  d = shape.node(i, j + 1);
      add_split_quad({a, b, c, d}, (i + j) % 2 == 0, mesh.triangles);
    }
  return mesh;
}

}  // namespace taut
