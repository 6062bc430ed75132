#include "taut/contact/detection/clear_pairs.h"

#include <algorithm>
#include <cmath>

#include "taut/base/simd.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // about calls that pass vectors: here all of them are inlined
#endif

namespace taut::detail {

namespace {

using Lanes = double __attribute__((vector_size(32)));  // one a pair
using LaneMask = long long __attribute__((vector_size(32)));
constexpr Index lanes = 4;

// Bounds all rounding between given coordinates and a tested inequality: 16 u, where 10 u would do (docs/mathematics.md, 6.3).
constexpr double rounding_bound = 16.0 * 0x1p-53;
constexpr double underflow_bound = 1e-307;
constexpr double least_square = 1e-280;  // of a normal: below, its length is lost in underflow

struct Lanes3 {
  Lanes x, y, z;
};

TAUT_ALWAYS_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
TAUT_ALWAYS_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
TAUT_ALWAYS_INLINE Lanes3 operator*(const Lanes& s, const Lanes3& a) { return {s * a.x, s * a.y, s * a.z}; }
TAUT_ALWAYS_INLINE Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
TAUT_ALWAYS_INLINE Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
TAUT_ALWAYS_INLINE Lanes absolute(const Lanes& a) { return a > 0.0 ? a : -a; }
TAUT_ALWAYS_INLINE Lanes3 absolute(const Lanes3& a) { return {absolute(a.x), absolute(a.y), absolute(a.z)}; }
TAUT_ALWAYS_INLINE Lanes smaller(const Lanes& a, const Lanes& b) { return a < b ? a : b; }
TAUT_ALWAYS_INLINE Lanes larger(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
TAUT_ALWAYS_INLINE Lanes3 orthogonal(const Lanes3& w, const Lanes3& e) { return w - (dot(w, e) / dot(e, e)) * e; }
TAUT_ALWAYS_INLINE Lanes root(const Lanes& a) { return Lanes{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])}; }

// A pair at one time. between: from the first corner of the second shape to the first of the first; first and second: edges a b and c d; of
// a triangle, both sides at its first corner.
struct Shapes {
  Lanes3 between, first, second;
};

TAUT_ALWAYS_INLINE Lanes3 corner(const PairCorners* pairs, int k, const Vec3* x) {
  const double *a = x[pairs[0][k]].data(), *b = x[pairs[1][k]].data(), *c = x[pairs[2][k]].data(), *d = x[pairs[3][k]].data();
  return {Lanes{a[0], b[0], c[0], d[0]}, Lanes{a[1], b[1], c[1], d[1]}, Lanes{a[2], b[2], c[2], d[2]}};
}

template <bool edges>
TAUT_ALWAYS_INLINE Shapes shapes_at(const PairCorners* pairs, const Vec3* x) {
  const Lanes3 a = corner(pairs, 0, x), b = corner(pairs, 1, x), c = corner(pairs, 2, x), d = corner(pairs, 3, x);
  if constexpr (edges) return {a - c, b - a, d - c};
  return {a - b, c - b, d - b};
}

template <bool edges>
struct Planes {
  const Shapes &start, &end;
  Lanes3 size;  // sum of the magnitudes of all differences, at both ends: NaN where one of them is
  double distance;
  LaneMask at_start{}, throughout{};

  // The least of n·(point of the first shape - point of the second).
  TAUT_ALWAYS_INLINE static Lanes least(const Lanes3& n, const Shapes& s) {
    const Lanes first = dot(n, s.first), second = dot(n, s.second), zero{};
    if constexpr (edges) return dot(n, s.between) + smaller(first, zero) - larger(second, zero);
    return dot(n, s.between) - larger(larger(first, second), zero);
  }
  TAUT_ALWAYS_INLINE void attempt(const Lanes3& n) {
    const Lanes square = dot(n, n), kept = distance * root(square);
    const Lanes needed = kept + rounding_bound * (dot(absolute(n), size) + kept) + underflow_bound;
    const LaneMask now = (square > least_square) & (least(n, start) > needed);
    at_start |= now;
    throughout |= now & (least(n, end) > needed);
  }
  TAUT_ALWAYS_INLINE void attempt_towards(const Lanes3& n, const Lanes3& side) {
    const Lanes along = dot(n, side), one = {1.0, 1.0, 1.0, 1.0};
    attempt((along < 0.0 ? -one : one) * n);
  }
};

template <bool edges>
TAUT_ALWAYS_INLINE void find_clear_four(const PairCorners* pairs, const Vec3* x0, const Vec3* x1, double distance, std::uint8_t* clear) {
  const Shapes start = shapes_at<edges>(pairs, x0), end = shapes_at<edges>(pairs, x1);
  const Lanes3 size = absolute(start.between) + absolute(start.first) + absolute(start.second) + absolute(end.between) +
                      absolute(end.first) + absolute(end.second);
  Planes<edges> planes{start, end, size, distance};
  // Twice the mean.
  const Lanes3 between = start.between + end.between, first = start.first + end.first, second = start.second + end.second;
  if constexpr (edges) {
    const Lanes half = {0.5, 0.5, 0.5, 0.5};
    const Lanes3 middle = between + half * (first - second);
    planes.attempt(middle);
    planes.attempt(orthogonal(middle, first));
    planes.attempt(orthogonal(middle, second));
    planes.attempt_towards(cross(first, second), middle);
  } else {
    const Lanes three = {3.0, 3.0, 3.0, 3.0};
    planes.attempt(three * between - (first + second));
    planes.attempt(orthogonal(between, first));
    planes.attempt(orthogonal(between, second));
    planes.attempt(orthogonal(between - first, second - first));
    planes.attempt_towards(cross(first, second), between);
  }
  for (int l = 0; l < lanes; ++l)
    clear[l] = static_cast<std::uint8_t>((planes.at_start[l] ? clear_at_start : 0) | (planes.throughout[l] ? clear_throughout : 0));
}

template <bool edges>
TAUT_ALWAYS_INLINE void find_all(const PairCorners* pairs, Index count, const Vec3* x0, const Vec3* x1, double distance,
                                 std::uint8_t* clear) {
  Index k = 0;
  for (; k + lanes <= count; k += lanes) find_clear_four<edges>(pairs + k, x0, x1, distance, clear + k);
  if (k == count) return;
  PairCorners last[lanes];
  std::uint8_t flags[lanes];
  for (Index l = 0; l < lanes; ++l) last[l] = pairs[std::min(k + l, count - 1)];
  find_clear_four<edges>(last, x0, x1, distance, flags);
  std::copy(flags, flags + (count - k), clear + k);
}

}  // namespace

TAUT_MULTIVERSION void find_clear_edges(const PairCorners* pairs, Index count, const Vec3* x0, const Vec3* x1, double distance,
                                        std::uint8_t* clear) {
  find_all<true>(pairs, count, x0, x1, distance, clear);
}

TAUT_MULTIVERSION void find_clear_triangles(const PairCorners* pairs, Index count, const Vec3* x0, const Vec3* x1, double distance,
                                            std::uint8_t* clear) {
  find_all<false>(pairs, count, x0, x1, distance, clear);
}

void find_clear(const PairCorners* pairs, Index count, bool edges, const Vec3* x0, const Vec3* x1, double distance, std::uint8_t* clear) {
  (edges ? find_clear_edges : find_clear_triangles)(pairs, count, x0, x1, distance, clear);
}

}  // namespace taut::detail
