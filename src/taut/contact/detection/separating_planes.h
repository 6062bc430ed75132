#pragma once
// The walk of contact/ccd.h along planes, for one pair: see there for why it misses nothing.
//
//   D_k(t) = (1 - t) D_k^0 + t D_k^1, k = 0 ... 3     differences of corners of the two shapes, m; a vertex and a triangle have three: the
//   last is
//                                                     given twice
//
// Private to contact.

#include <algorithm>
#include <cmath>

#include "taut/base/types.h"
#include "taut/contact/ccd.h"

namespace taut::detail {

// Bounds all rounding between given coordinates and a tested inequality: 16 u, where 9 u would do.
constexpr double rounding_bound = 16.0 * 0x1p-53;
constexpr double length_bound = 1e-12;      // by which a unit normal may be too long
constexpr double underflow_bound = 1e-307;  // products that are too small to have a relative error

class SeparatingPlanes {
 public:
  SeparatingPlanes(const Vec3 (&start)[4], const Vec3 (&end)[4]) {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      double largest = 0.0;
      for (int k = 0; k < 4; ++k) {
        start_[i][k] = start[k][i];
        end_[i][k] = end[k][i];
        largest = std::max(largest, std::max(std::abs(start[k][i]), std::abs(end[k][i])));
        sum += std::abs(start[k][i]) + std::abs(end[k][i]);  // a NaN gets lost in max, but not here
      }
      largest_[i] = largest;
    }
    in_range_ = sum < 1e300;
  }

  // Finite, and far from overflow. Nothing is proved about others.
  bool in_range() const { return in_range_; }

  // Does a plane across an axis separate the pair all the time?
  bool boxes_apart(double separation) const {
    for (int i = 0; i < 3; ++i) {
      double least = start_[i][0], most = start_[i][0];
      for (int k = 0; k < 4; ++k) {
        least = std::min(least, std::min(start_[i][k], end_[i][k]));
        most = std::max(most, std::max(start_[i][k], end_[i][k]));
      }
      const double needed = separation + rounding_bound * (largest_[i] + separation) + underflow_bound;
      if (least > needed || -most > needed) return true;
    }
    return false;
  }

  // The direction between the middles of the two shapes, halfway through. For most pairs that are only near each other its plane is enough.
  Vec3 between_middles() const {
    Vec3 n;
    for (int i = 0; i < 3; ++i)
      n[i] = ((start_[i][0] + start_[i][1]) + (start_[i][2] + start_[i][3])) + ((end_[i][0] + end_[i][1]) + (end_[i][2] + end_[i][3]));
    return n / std::sqrt(n.squaredNorm());
  }

  // The last time s in [r, 1] such that the plane with normal n is seen to separate the pair throughout [r, s]; -1 if it does not even at
  // r, or if n is not of length 1 to 1e-12.
  double separated_until(const Vec3& n, double r, double separation) const {
    if (!(n.squaredNorm() < 1.0 + length_bound)) return -1.0;
    double at_start[4], at_end[4];
    for (int k = 0; k < 4; ++k) {
      at_start[k] = n[0] * start_[0][k] + n[1] * start_[1][k] + n[2] * start_[2][k];
      at_end[k] = n[0] * end_[0][k] + n[1] * end_[1][k] + n[2] * end_[2][k];
    }
    const double size = std::abs(n[0]) * largest_[0] + std::abs(n[1]) * largest_[1] + std::abs(n[2]) * largest_[2];
    const double rounding = rounding_bound * size + length_bound * separation + underflow_bound;
    const double needed = separation + rounding;
    if (!(least_at(at_start, at_end, r) > needed)) return -1.0;
    // Aims a little above what is needed, so that the rounding of s itself does not spoil the test.
    double s = 1.0;
    for (int k = 0; k < 4; ++k)
      if (!(at_end[k] > needed)) s = std::min(s, (at_start[k] - needed - rounding) / (at_start[k] - at_end[k]));
    if (!(s > r)) return r;
    return least_at(at_start, at_end, s) > needed ? s : r;
  }

 private:
  static double least_at(const double (&at_start)[4], const double (&at_end)[4], double t) {
    double least = (1.0 - t) * at_start[0] + t * at_end[0];
    for (int k = 1; k < 4; ++k) {
      const double value = (1.0 - t) * at_start[k] + t * at_end[k];
      least = value < least ? value : least;
    }
    return least;
  }

  double start_[3][4], end_[3][4];
  double largest_[3];
  bool in_range_;
};

}  // namespace taut::detail
