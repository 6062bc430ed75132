#pragma once
// Which of many pairs a plane surely keeps apart, cheaply: most pairs of the broad phase are
// neighbours in a smooth piece of cloth, and need no closest points. Private to contact.
//
//   corners    of a pair: vertex p, then a, b, c of the triangle; or a, b of the first edge, then
//              c, d of the second
//   distance   m
//
// Tried are planes across the line between the middles of the two shapes; across that line's part
// orthogonal to an edge; and across the normal of the triangle, of both edges. All are of the mean
// of start and end. A plane counts when it leaves more than `distance` between the shapes at the
// start, or at both ends: and then, since all motion is linear, all the way. What is called clear
// is proved, rounding included (docs/mathematics.md, 6); the reverse does not hold. Numbers that
// are not finite are not clear. Several pairs side by side, each by itself: the result does not
// depend on which come together.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "taut/base/types.h"

namespace taut::detail {

using PairCorners = std::array<Index, 4>;

constexpr std::uint8_t clear_at_start = 1, clear_throughout = 2;

// clear[k]: the flags of pair k. x0, x1: m, of all vertices, at the start and at the end.
void find_clear(const PairCorners* pairs, Index count, bool edges, const Vec3* x0, const Vec3* x1,
                double distance, std::uint8_t* clear);

// The same in single precision, twice as many pairs at once, and as sure: what the coordinates lose
// is added to the distance (docs/mathematics.md, 6.8). Finds nearly as many pairs clear, where the
// scene is not a million times larger than the distance.
struct alignas(32) FloatWay {
  // m, from the middle of all: x, y, z at the start and at the end, and one unused
  float at[2][4] = {};
};

// Ends a, b of a segment, corners c, d, e of a triangle.
using SegmentTriangle = std::array<Index, 5>;

class FloatWays {
 public:
  // Of all vertices; x0, x1: as above.
  void set(std::span<const Vec3> x0, std::span<const Vec3> x1);
  void find_clear(const PairCorners* pairs, Index count, bool edges, double distance,
                  std::uint8_t* clear) const;
  // apart[k]: not 0 where a plane surely separates segment and triangle at the start: across the
  // line between their middles, or across that line's part orthogonal to the segment, or the
  // triangle's normal.
  void find_apart(const SegmentTriangle* pairs, Index count, std::uint8_t* apart) const;

 private:
  float widened(double distance) const;  // by what the coordinates have lost

  std::vector<FloatWay> ways_;
  double coordinate_error_ = 0.0;  // m
};

}  // namespace taut::detail
