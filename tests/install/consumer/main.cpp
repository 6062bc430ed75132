// A program outside Taut that uses the installed library.
#include <cstdio>

#include "taut/base/parallel.h"
#include "taut/mesh/grid.h"

int main() {
  taut::GridShape shape;
  shape.nu = 5;
  shape.nv = 4;
  const taut::TriangleMesh mesh = taut::make_grid(shape);
  // A parallel loop makes the consumer link one of libtaut's own libraries too.
  const double height = taut::ordered_sum(
      static_cast<taut::Index>(mesh.positions.size()), [&](taut::Index begin, taut::Index end) {
        double sum = 0.0;
        for (taut::Index i = begin; i < end; ++i)
          sum += mesh.positions[static_cast<std::size_t>(i)].z();
        return sum;
      });
  std::printf("nodes %zu, triangles %zu, sum of heights %g\n", mesh.positions.size(),
              mesh.triangles.size(), height);
}
