#pragma once
// A quadrilateral a b c d, counterclockwise, as two triangles of the same orientation: cut from a
// to c, or from b to d. Neighbouring cells of a grid are cut in turns, so that the cloth has no
// direction in which it folds more easily.

#include <array>
#include <vector>

#include "taut/mesh/triangle_mesh.h"

namespace taut {

inline void add_split_quad(const std::array<Index, 4>& quad, bool cut_from_first,
                           std::vector<Triangle>& triangles) {
  const auto [a, b, c, d] = quad;
  if (cut_from_first) {
    triangles.insert(triangles.end(), {Triangle{a, b, c}, Triangle{a, c, d}});
  } else {
    triangles.insert(triangles.end(), {Triangle{a, b, d}, Triangle{b, c, d}});
  }
}

}  // namespace taut
