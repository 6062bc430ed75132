#pragma once
// A vertex and a triangle (corners p a b c), or two edges (a b, c d), that move from the first four
// corners to the last four; and their distance in long double, by comparing all features, without
// anything from src.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "taut/contact/ccd.h"

namespace taut::test {

using Corners = std::array<Vec3, 8>;
using LongVec = Eigen::Matrix<long double, 3, 1>;
enum class PairKind { vertex_triangle, edge_edge };

inline Impact impact_of(PairKind kind, const Corners& x, const CcdOptions& options) {
  return kind == PairKind::vertex_triangle
             ? vertex_triangle_impact(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], options)
             : edge_edge_impact(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], options);
}

inline long double segment_distance(const LongVec& p, const LongVec& a, const LongVec& b) {
  const LongVec e = b - a;
  const long double e2 = e.squaredNorm();
  const long double s = e2 > 0 ? std::clamp<long double>((p - a).dot(e) / e2, 0, 1) : 0;
  return (p - a - s * e).norm();
}

inline long double triangle_distance(const LongVec& p, const LongVec& a, const LongVec& b,
                                     const LongVec& c) {
  long double least =
      std::min({segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
  const LongVec n = (b - a).cross(c - a);
  const bool above = n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
                     n.dot((a - c).cross(p - c)) >= 0;
  if (n.norm() > 0 && above) least = std::min(least, std::abs(n.dot(p - a)) / n.norm());
  return least;
}

inline long double edge_distance(const LongVec& a, const LongVec& b, const LongVec& c,
                                 const LongVec& d) {
  long double least = std::min({segment_distance(a, c, d), segment_distance(b, c, d),
                                segment_distance(c, a, b), segment_distance(d, a, b)});
  const LongVec e = b - a, f = d - c, n = e.cross(f), r = a - c;
  const long double n2 = n.squaredNorm();
  if (n2 > 0) {
    const long double s = f.cross(r).dot(n) / n2, t = e.cross(r).dot(n) / n2;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1)
      least = std::min(least, std::abs(n.dot(r)) / std::sqrt(n2));
  }
  return least;
}

inline long double distance_at(PairKind kind, const Corners& x, long double t) {
  const auto at = [&](int k) -> LongVec {
    return (1 - t) * x[k].cast<long double>() + t * x[k + 4].cast<long double>();
  };
  return kind == PairKind::vertex_triangle ? triangle_distance(at(0), at(1), at(2), at(3))
                                           : edge_distance(at(0), at(1), at(2), at(3));
}

// Bound on how fast the distance changes with t, m.
inline long double speed_bound(const Corners& x) {
  long double most = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j)
      most = std::max<long double>(most, ((x[i + 4] - x[i]) - (x[j + 4] - x[j])).norm());
  return most;
}

// Is the distance above `least` at all t in [from, to]? Halves the interval until the speed bound
// settles it, or gives up and says no.
inline bool surely_above(PairKind kind, const Corners& x, long double least, long double from,
                         long double to, int depth = 40) {
  const long double middle = (from + to) / 2, distance = distance_at(kind, x, middle);
  if (distance - speed_bound(x) * (to - from) / 2 > least) return true;
  if (distance <= least || depth == 0) return false;
  return surely_above(kind, x, least, from, middle, depth - 1) &&
         surely_above(kind, x, least, middle, to, depth - 1);
}

}  // namespace taut::test
