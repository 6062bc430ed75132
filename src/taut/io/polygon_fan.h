#pragma once
// Cuts a polygon p_0 ... p_{n-1} of a mesh file into n - 2 triangles.
//
//   triangles (s, s+1, s+2), (s, s+2, s+3), ...   indices modulo n, s = the start of the fan
//   normal    sum of p_i x p_{i+1}   (Newell; m^2, points to the front)
//
// A convex polygon starts at s = 0. A fan of a polygon with a dent may fold over itself, so s is
// the first corner from which no triangle shows its back (triangle normal . normal >= 0).

#include <optional>
#include <span>
#include <vector>

#include "taut/mesh/triangle_mesh.h"

namespace taut {

// The first start without a fold; none when every fan folds (of more than 64 corners: when the
// first does). `corner` holds vertex indices, all within `positions`. O(n^2) at worst.
std::optional<Index> unfolded_fan_start(std::span<const Index> corner,
                                        std::span<const Vec3> positions);

// Appends the fan's triangles.
void append_fan(std::span<const Index> corner, Index start, std::vector<Triangle>& triangles);

}  // namespace taut
