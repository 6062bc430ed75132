#include "taut/mesh/tube.h"

#include <cmath>
#include <numbers>

#include "taut/mesh/split_quad.h"

namespace taut {

TriangleMesh make_tube(const TubeShape& shape) {
  TriangleMesh mesh;
  for (Index j = 0; j < shape.along; ++j)
    for (Index i = 0; i < shape.around; ++i) {
      const double turn = double(i) / shape.around, angle = 2.0 * std::numbers::pi * turn,
                   v = double(j) / (shape.along - 1);
      mesh.positions.emplace_back(shape.radius * std::cos(angle), shape.radius * std::sin(angle),
                                  shape.height * (v - 0.5));
      // The texture runs there and back: a seam would need nodes twice.
      mesh.texcoords.emplace_back(1.0 - std::abs(2.0 * turn - 1.0), v);
    }
  const auto node = [&](Index i, Index j) { return j * shape.around + i % shape.around; };
  for (Index j = 0; j + 1 < shape.along; ++j)
    for (Index i = 0; i < shape.around; ++i) {
      const Index a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
      add_split_quad({a, b, c, d}, (i + j) % 2 == 0, mesh.triangles);
    }
  return mesh;
}

}  // namespace taut
