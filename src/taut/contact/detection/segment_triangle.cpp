// Exact decision whether a segment meets a triangle, both closed.

#include <algorithm>
#include <array>

#include "taut/contact/detection/orientation.h"
#include "taut/contact/intersection.h"

namespace taut {

namespace {

using detail::orientation;

// p, on the line a b as seen along the axis, lies within the segment's box as seen along it.
bool within(const Vec3& p, const Vec3& a, const Vec3& b, int axis) {
  for (int k = 1; k < 3; ++k) {
    const int i = (axis + k) % 3;
    if (p[i] < std::min(a[i], b[i]) || p[i] > std::max(a[i], b[i])) return false;
  }
  return true;
}

// As seen along the axis.
bool segments_meet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, int axis) {
  const int abc = orientation(a, b, c, axis), abd = orientation(a, b, d, axis);
  const int cda = orientation(c, d, a, axis), cdb = orientation(c, d, b, axis);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && within(c, a, b, axis)) || (abd == 0 && within(d, a, b, axis)) ||
         (cda == 0 && within(a, c, d, axis)) || (cdb == 0 && within(b, c, d, axis));
}

bool in_triangle(const Vec3& p, const Vec3& c, const Vec3& d, const Vec3& e, int axis) {
  const int whole = orientation(c, d, e, axis);
  if (whole == 0) return false;  // then only its sides count
  return whole * orientation(c, d, p, axis) >= 0 && whole * orientation(d, e, p, axis) >= 0 &&
         whole * orientation(e, c, p, axis) >= 0;
}

// For five points in one plane. What meets is seen to meet along every axis; and along at least one
// axis nothing is lost, since the plane (the line, where all lie on one) is not seen edge-on
// (end-on) along all three.
bool meet_in_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
  for (int axis = 0; axis < 3; ++axis)
    if (!segments_meet(a, b, c, d, axis) && !segments_meet(a, b, d, e, axis) &&
        !segments_meet(a, b, e, c, axis) && !in_triangle(a, c, d, e, axis))
      return false;
  return true;
}

}  // namespace

Meeting segment_meets_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                               const Vec3& e) {
  const int side_a = orientation(c, d, e, a), side_b = orientation(c, d, e, b);
  if (side_a * side_b > 0) return {};
  // On which side of each of the triangle's sides the line a b passes.
  const std::array<int, 3> turns{orientation(a, b, c, d), orientation(a, b, d, e),
                                 orientation(a, b, e, c)};
  bool left = false, right = false, touching = side_a == 0 || side_b == 0;
  for (const int turn : turns) {
    left |= turn > 0;
    right |= turn < 0;
    touching |= turn == 0;
  }
  if (left && right) return {};
  if (left || right) {
    if (side_a == 0 && side_b == 0) return {};  // cannot be: all in one plane means all turns are 0
    return {true, touching};
  }
  return {meet_in_plane(a, b, c, d, e), true};
}

}  // namespace taut
