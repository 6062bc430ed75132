#pragma once
// The planes of contact/ccd.h, for one pair: docs/mathematics.md, 6, says why they miss nothing.
//
//   D_k(t) = (1 - t) D_k^0 + t D_k^1, k = 0 ... 3   differences of corners of the two shapes, m; a
//                                                   vertex and a triangle have three: the last is
//                                                   given twice
//
// Four lanes side by side, one a difference. Private to contact.

#include <algorithm>
#include <cmath>

#include "taut/base/simd.h"
#include "taut/base/types.h"

namespace taut::detail {

// Bounds all rounding between given coordinates and a tested inequality: 16 u, where 9 u would do.
constexpr double rounding_bound = 16.0 * 0x1p-53;
constexpr double length_bound = 1e-12;      // by which a unit normal may be too long
constexpr double underflow_bound = 1e-307;  // products that are too small to have a relative error

class SeparatingPlanes {
  using Lanes = double __attribute__((vector_size(32)));

 public:
  // Of a vertex p and a triangle a b c; of two edges a b and c d. x: the
  // corners at one end of the time.
  struct VertexTriangle {};
  struct EdgeEdge {};
  TAUT_ALWAYS_INLINE SeparatingPlanes(VertexTriangle, const Vec3* const (&x0)[4],
                                      const Vec3* const (&x1)[4]) {
    for (int i = 0; i < 3; ++i) {
      start_[i] = (*x0[0])[i] - Lanes{(*x0[1])[i], (*x0[2])[i], (*x0[3])[i], (*x0[3])[i]};
      end_[i] = (*x1[0])[i] - Lanes{(*x1[1])[i], (*x1[2])[i], (*x1[3])[i], (*x1[3])[i]};
    }
    measure();
  }
  TAUT_ALWAYS_INLINE SeparatingPlanes(EdgeEdge, const Vec3* const (&x0)[4],
                                      const Vec3* const (&x1)[4]) {
    for (int i = 0; i < 3; ++i) {
      start_[i] = Lanes{(*x0[0])[i], (*x0[0])[i], (*x0[1])[i], (*x0[1])[i]} -
                  Lanes{(*x0[2])[i], (*x0[3])[i], (*x0[2])[i], (*x0[3])[i]};
      end_[i] = Lanes{(*x1[0])[i], (*x1[0])[i], (*x1[1])[i], (*x1[1])[i]} -
                Lanes{(*x1[2])[i], (*x1[3])[i], (*x1[2])[i], (*x1[3])[i]};
    }
    measure();
  }

  // Finite, and far from overflow. Nothing is proved about others.
  TAUT_ALWAYS_INLINE bool in_range() const { return in_range_; }

  // Does a plane across an axis, or between the middles of the two shapes, separate the pair all
  // the time? Settles most pairs. Only for those in range.
  TAUT_ALWAYS_INLINE bool far_apart(double separation) const {
    // Without branches: which plane does it is anybody's guess.
    bool apart = false;
    double n[3];
    for (int i = 0; i < 3; ++i) {
      const double needed =
          separation + rounding_bound * (largest_[i] + separation) + underflow_bound;
      const Lanes low = start_[i] < end_[i] ? start_[i] : end_[i],
                  high = start_[i] > end_[i] ? start_[i] : end_[i];
      apart |= (least(low) > needed) | (-most(high) > needed);
      n[i] = sum(start_[i] + end_[i]);
    }
    const Lanes at_start = n[0] * start_[0] + n[1] * start_[1] + n[2] * start_[2];
    const Lanes at_end = n[0] * end_[0] + n[1] * end_[1] + n[2] * end_[2];
    const Lanes low = at_start < at_end ? at_start : at_end;
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const double needed =
        separation * length + rounding_bound * (size(n) + separation * length) + underflow_bound;
    return apart | (least(low) > needed);
  }

  // The last time s in [r, 1] such that the plane with normal n is seen to separate the pair
  // throughout [r, s]; -1 if it does not even at r, or if n is not of length 1 to 1e-12.
  double separated_until(const Vec3& n, double r, double separation) const {
    if (!(n.squaredNorm() < 1.0 + length_bound)) return -1.0;
    double at_start[4], at_end[4];
    for (int k = 0; k < 4; ++k) {
      at_start[k] = n[0] * start_[0][k] + n[1] * start_[1][k] + n[2] * start_[2][k];
      at_end[k] = n[0] * end_[0][k] + n[1] * end_[1][k] + n[2] * end_[2][k];
    }
    const double rounding =
        rounding_bound * size(n.data()) + length_bound * separation + underflow_bound;
    const double needed = separation + rounding;
    if (!(least_at(at_start, at_end, r) > needed)) return -1.0;
    // Aims a little above what is needed, so that the rounding of s itself does not spoil the test.
    double s = 1.0;
    for (int k = 0; k < 4; ++k)
      if (!(at_end[k] > needed))
        s = std::min(s, (at_start[k] - needed - rounding) / (at_start[k] - at_end[k]));
    if (!(s > r)) return r;
    return least_at(at_start, at_end, s) > needed ? s : r;
  }

 private:
  static double least_at(const double (&at_start)[4], const double (&at_end)[4], double t) {
    double value[4];
    for (int k = 0; k < 4; ++k) value[k] = (1.0 - t) * at_start[k] + t * at_end[k];
    return std::min(std::min(value[0], value[1]), std::min(value[2], value[3]));
  }
  static TAUT_ALWAYS_INLINE double least(const Lanes& a) {
    return std::min(std::min(a[0], a[1]), std::min(a[2], a[3]));
  }
  static TAUT_ALWAYS_INLINE double most(const Lanes& a) {
    return std::max(std::max(a[0], a[1]), std::max(a[2], a[3]));
  }
  static TAUT_ALWAYS_INLINE double sum(const Lanes& a) { return (a[0] + a[1]) + (a[2] + a[3]); }
  // S of docs/mathematics.md, 6.3.
  TAUT_ALWAYS_INLINE double size(const double* n) const {
    return std::abs(n[0]) * largest_[0] + std::abs(n[1]) * largest_[1] +
           std::abs(n[2]) * largest_[2];
  }

  TAUT_ALWAYS_INLINE void measure() {
    Lanes total{};
    for (int i = 0; i < 3; ++i) {
      const Lanes a = start_[i] > 0.0 ? start_[i] : -start_[i],
                  b = end_[i] > 0.0 ? end_[i] : -end_[i];
      const Lanes larger = a > b ? a : b;
      largest_[i] = most(larger);
      total += a + b;  // a NaN gets lost in a comparison, but not here
    }
    in_range_ = sum(total) < 1e100;
  }

  Lanes start_[3], end_[3];
  double largest_[3];
  bool in_range_;
};

}  // namespace taut::detail
