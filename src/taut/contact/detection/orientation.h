#pragma once
// Exact signs of determinants. Private to contact.

#include "taut/base/types.h"

namespace taut::detail {

// Sign of det[a - d, b - d, c - d], six times the volume of a tetrahedron: +1, 0 or -1.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// The same for the triangle a b c seen along an axis, so in two coordinates: det[a - c, b - c] of
// coordinates axis + 1 and axis + 2.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

}  // namespace taut::detail
