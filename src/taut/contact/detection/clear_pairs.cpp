#include "taut/contact/detection/clear_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored \
    "-Wpsabi"  // about calls that pass vectors: here all of them are inlined
#endif

namespace taut::detail {

namespace {

// One lane a pair.
template <class T>
constexpr Index lanes = 32 / static_cast<Index>(sizeof(T));
typedef double DoubleLanes __attribute__((vector_size(32)));
typedef float FloatLanes __attribute__((vector_size(32)));
typedef float FloatHalf __attribute__((vector_size(16)));
typedef std::int64_t DoubleMask __attribute__((vector_size(32)));
typedef std::int32_t FloatMask __attribute__((vector_size(32)));

// Of a precision with unit roundoff u.
template <class T>
struct Precision;
template <>
struct Precision<double> {
  using Lanes = DoubleLanes;
  using Mask = DoubleMask;
  static constexpr double u = 0x1p-53, underflow_bound = 1e-307;
  // of a normal: below, its length is lost in underflow
  static constexpr double least_square = 1e-280;
};
template <>
struct Precision<float> {
  using Lanes = FloatLanes;
  using Mask = FloatMask;
  static constexpr float u = 0x1p-24f, underflow_bound = 1e-36f;
  static constexpr float least_square = 1e-28f;
};

// Bounds all rounding between the coordinates and a tested inequality, in units of u, where 10
// would do (docs/mathematics.md, 6.3).
constexpr int rounding_bound = 16;

template <class T>
using Lanes = typename Precision<T>::Lanes;
template <class T>
using LaneMask = typename Precision<T>::Mask;

template <class T>
TAUT_ALWAYS_INLINE LaneMask<T> sign_bit() {
  return (LaneMask<T>)(-Lanes<T>{});
}

template <class T>
struct Lanes3 {
  Lanes<T> x, y, z;

  TAUT_ALWAYS_INLINE friend Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  TAUT_ALWAYS_INLINE friend Lanes3 operator-(const Lanes3& a, const Lanes3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  TAUT_ALWAYS_INLINE friend Lanes3 operator*(const Lanes<T>& s, const Lanes3& a) {
    return {s * a.x, s * a.y, s * a.z};
  }
  TAUT_ALWAYS_INLINE friend Lanes<T> dot(const Lanes3& a, const Lanes3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  TAUT_ALWAYS_INLINE friend Lanes3 cross(const Lanes3& a, const Lanes3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  TAUT_ALWAYS_INLINE friend Lanes3 absolute(const Lanes3& a) {
    return {magnitude(a.x), magnitude(a.y), magnitude(a.z)};
  }
  TAUT_ALWAYS_INLINE friend Lanes3 orthogonal(const Lanes3& w, const Lanes3& e) {
    return w - (dot(w, e) / dot(e, e)) * e;
  }

 private:
  TAUT_ALWAYS_INLINE static Lanes<T> magnitude(const Lanes<T>& a) {
    return (Lanes<T>)((LaneMask<T>)a & ~sign_bit<T>());
  }
};

template <class T>
TAUT_ALWAYS_INLINE Lanes<T> smaller(const Lanes<T>& a, const Lanes<T>& b) {
  return a < b ? a : b;
}
template <class T>
TAUT_ALWAYS_INLINE Lanes<T> larger(const Lanes<T>& a, const Lanes<T>& b) {
  return a > b ? a : b;
}
TAUT_ALWAYS_INLINE DoubleLanes root(const DoubleLanes& a) {
  return DoubleLanes{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
TAUT_ALWAYS_INLINE FloatLanes root(const FloatLanes& a) {
  return FloatLanes{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3]),
                    std::sqrt(a[4]), std::sqrt(a[5]), std::sqrt(a[6]), std::sqrt(a[7])};
}

// Pairs at one time. between: from the first corner of the second shape to the first of the first;
// first and second: edges a b and c d; of a triangle, both sides at its first corner.
template <class T>
struct Shapes {
  Lanes3<T> between, first, second;
};

template <bool edges, class T>
TAUT_ALWAYS_INLINE Shapes<T> shapes_of(const Lanes3<T>& a, const Lanes3<T>& b, const Lanes3<T>& c,
                                       const Lanes3<T>& d) {
  if constexpr (edges) return {a - c, b - a, d - c};
  return {a - b, c - b, d - b};
}

// The corners of as many pairs as there are lanes, at both ends.
struct DoublePositions {
  using Scalar = double;
  const Vec3 *x0, *x1;

  TAUT_ALWAYS_INLINE static Lanes3<double> corner(const PairCorners* pairs, int k, const Vec3* x) {
    const double *a = x[pairs[0][k]].data(), *b = x[pairs[1][k]].data(), *c = x[pairs[2][k]].data(),
                 *d = x[pairs[3][k]].data();
    return {DoubleLanes{a[0], b[0], c[0], d[0]}, DoubleLanes{a[1], b[1], c[1], d[1]},
            DoubleLanes{a[2], b[2], c[2], d[2]}};
  }
  TAUT_ALWAYS_INLINE void corners(const PairCorners* pairs, int k, Lanes3<double>& start,
                                  Lanes3<double>& end) const {
    start = corner(pairs, k, x0);
    end = corner(pairs, k, x1);
  }
};

struct FloatPositions {
  using Scalar = float;
  const FloatWay* way;

  TAUT_ALWAYS_INLINE FloatLanes of(Index vertex) const {
    FloatLanes v;
    __builtin_memcpy(&v, &way[vertex], sizeof v);
    return v;
  }
  // Transposes eight vertices of eight floats.
  TAUT_ALWAYS_INLINE void corners(const PairCorners* pairs, int k, Lanes3<float>& start,
                                  Lanes3<float>& end) const {
    FloatLanes low[4], high[4];  // x and y, z and nothing, of two vertices each that are four apart
    for (int i = 0; i < 4; ++i) {
      const FloatLanes a = of(pairs[i][k]), b = of(pairs[i + 4][k]);
      low[i] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
      high[i] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
    }
    transpose(low, start);
    transpose(high, end);
  }
  // Of eight vertices at the start.
  template <class List>
  TAUT_ALWAYS_INLINE Lanes3<float> corner(const List* lists, int k) const {
    FloatLanes v[4];
    for (int i = 0; i < 4; ++i) {
      FloatHalf a, b;
      __builtin_memcpy(&a, &way[lists[i][k]], sizeof a);
      __builtin_memcpy(&b, &way[lists[i + 4][k]], sizeof b);
      v[i] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
    }
    Lanes3<float> corner;
    transpose(v, corner);
    return corner;
  }
  TAUT_ALWAYS_INLINE static void transpose(const FloatLanes* v, Lanes3<float>& to) {
    const FloatLanes xy01 = __builtin_shufflevector(v[0], v[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const FloatLanes xy23 = __builtin_shufflevector(v[2], v[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const FloatLanes z01 = __builtin_shufflevector(v[0], v[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const FloatLanes z23 = __builtin_shufflevector(v[2], v[3], 2, 10, 3, 11, 6, 14, 7, 15);
    to.x = __builtin_shufflevector(xy01, xy23, 0, 1, 8, 9, 4, 5, 12, 13);
    to.y = __builtin_shufflevector(xy01, xy23, 2, 3, 10, 11, 6, 7, 14, 15);
    to.z = __builtin_shufflevector(z01, z23, 0, 1, 8, 9, 4, 5, 12, 13);
  }
};

template <bool edges, class T>
struct Planes {
  const Shapes<T>&start, &end;
  // sum of the magnitudes of all differences, at both ends: NaN where one of them is
  Lanes3<T> size;
  T distance;
  LaneMask<T> at_start{}, throughout{};

  // The least of n·(point of the first shape - point of the second).
  TAUT_ALWAYS_INLINE static Lanes<T> least(const Lanes3<T>& n, const Shapes<T>& s) {
    const Lanes<T> first = dot(n, s.first), second = dot(n, s.second), zero{};
    if constexpr (edges)
      return dot(n, s.between) + smaller<T>(first, zero) - larger<T>(second, zero);
    return dot(n, s.between) - larger<T>(larger<T>(first, second), zero);
  }
  TAUT_ALWAYS_INLINE void attempt(const Lanes3<T>& n) {
    constexpr T bound = rounding_bound * Precision<T>::u;
    const Lanes<T> square = dot(n, n), kept = distance * root(square);
    const Lanes<T> needed =
        kept + bound * (dot(absolute(n), size) + kept) + Precision<T>::underflow_bound;
    const LaneMask<T> now = (square > Precision<T>::least_square) & (least(n, start) > needed);
    at_start |= now;
    throughout |= now & (least(n, end) > needed);
  }
  TAUT_ALWAYS_INLINE bool all_clear() const {
    const DoubleMask all = (DoubleMask)throughout;  // of either precision
    return (all[0] & all[1] & all[2] & all[3]) == -1;
  }
  TAUT_ALWAYS_INLINE void attempt_towards(const Lanes3<T>& n, const Lanes3<T>& side) {
    const LaneMask<T> flip = (LaneMask<T>)dot(n, side) & sign_bit<T>();
    const auto towards = [&](const Lanes<T>& a) __attribute__((always_inline)) {
      return (Lanes<T>)((LaneMask<T>)a ^ flip);
    };
    attempt({towards(n.x), towards(n.y), towards(n.z)});
  }
};

// Of eight segments and triangles: is there a plane between them?
struct SegmentPlanes {
  Lanes3<float> between, segment, first, second;  // a - c, b - a, d - c, e - c
  Lanes3<float> size;                             // sum of the magnitudes of all these
  float distance;
  LaneMask<float> apart{};

  TAUT_ALWAYS_INLINE void attempt(const Lanes3<float>& n) {
    constexpr float bound = rounding_bound * Precision<float>::u;
    const FloatLanes zero{}, square = dot(n, n), kept = distance * root(square);
    const FloatLanes needed =
        kept + bound * (dot(absolute(n), size) + kept) + Precision<float>::underflow_bound;
    const FloatLanes least = dot(n, between) + smaller<float>(dot(n, segment), zero) -
                             larger<float>(larger<float>(dot(n, first), dot(n, second)), zero);
    apart |= (square > Precision<float>::least_square) & (least > needed);
  }
};

TAUT_ALWAYS_INLINE void find_apart_few(const SegmentTriangle* pairs,
                                       const FloatPositions& positions, float distance,
                                       std::uint8_t* apart) {
  Lanes3<float> x[5];
  for (int k = 0; k < 5; ++k) x[k] = positions.corner(pairs, k);
  SegmentPlanes planes{x[0] - x[2], x[1] - x[0], x[3] - x[2], x[4] - x[2], {}, distance};
  planes.size = absolute(planes.between) + absolute(planes.segment) + absolute(planes.first) +
                absolute(planes.second);
  const auto times = [](float s) __attribute__((always_inline)) { return FloatLanes{} + s; };
  const Lanes3<float> middle = times(6) * planes.between + times(3) * planes.segment -
                               times(2) * (planes.first + planes.second);
  planes.attempt(middle);
  planes.attempt(orthogonal(middle, planes.segment));
  const Lanes3<float> normal = cross(planes.first, planes.second);
  const LaneMask<float> flip = (LaneMask<float>)dot(normal, middle) & sign_bit<float>();
  const auto towards = [&](const FloatLanes& a) __attribute__((always_inline)) {
    return (FloatLanes)((LaneMask<float>)a ^ flip);
  };
  planes.attempt({towards(normal.x), towards(normal.y), towards(normal.z)});
  for (int l = 0; l < lanes<float>; ++l) apart[l] = static_cast<std::uint8_t>(planes.apart[l] & 1);
}

// Of as many pairs as there are lanes.
template <bool edges, class Positions>
TAUT_ALWAYS_INLINE void find_clear_few(const PairCorners* pairs, const Positions& positions,
                                       typename Positions::Scalar distance, std::uint8_t* clear) {
  using T = typename Positions::Scalar;
  Lanes3<T> x0[4], x1[4];
  for (int k = 0; k < 4; ++k) positions.corners(pairs, k, x0[k], x1[k]);
  const Shapes<T> start = shapes_of<edges>(x0[0], x0[1], x0[2], x0[3]),
                  end = shapes_of<edges>(x1[0], x1[1], x1[2], x1[3]);
  const Lanes3<T> size = absolute(start.between) + absolute(start.first) + absolute(start.second) +
                         absolute(end.between) + absolute(end.first) + absolute(end.second);
  Planes<edges, T> planes{start, end, size, distance};
  // Twice the mean.
  const Lanes3<T> between = start.between + end.between, first = start.first + end.first,
                  second = start.second + end.second;
  if constexpr (edges) {
    const Lanes<T> half = Lanes<T>{} + T(0.5);
    const Lanes3<T> middle = between + half * (first - second);
    planes.attempt(middle);
    if (!planes.all_clear()) planes.attempt_towards(cross(first, second), middle);
    if (!planes.all_clear()) {
      planes.attempt(orthogonal(middle, first));
      planes.attempt(orthogonal(middle, second));
    }
  } else {
    const Lanes<T> three = Lanes<T>{} + T(3);
    planes.attempt(three * between - (first + second));
    if (!planes.all_clear()) planes.attempt_towards(cross(first, second), between);
    if (!planes.all_clear()) {
      planes.attempt(orthogonal(between, first));
      planes.attempt(orthogonal(between, second));
      planes.attempt(orthogonal(between - first, second - first));
    }
  }
  for (int l = 0; l < lanes<T>; ++l)
    clear[l] = static_cast<std::uint8_t>((planes.at_start[l] ? clear_at_start : 0) |
                                         (planes.throughout[l] ? clear_throughout : 0));
}

// find(pairs + k, flags + k) for every `few` of the pairs; the last ones are filled up
// with copies of the last.
template <Index few, class Pair, class Find>
TAUT_ALWAYS_INLINE void for_lanes(const Pair* pairs, Index count, std::uint8_t* flags,
                                  const Find& find) {
  Index k = 0;
  for (; k + few <= count; k += few) find(pairs + k, flags + k);
  if (k == count) return;
  Pair last[few];
  std::uint8_t last_flags[few];
  for (Index l = 0; l < few; ++l) last[l] = pairs[std::min(k + l, count - 1)];
  find(last, last_flags);
  std::copy(last_flags, last_flags + (count - k), flags + k);
}

template <bool edges, class Positions>
TAUT_ALWAYS_INLINE void find_all(const PairCorners* pairs, Index count, const Positions& positions,
                                 typename Positions::Scalar distance, std::uint8_t* clear) {
  for_lanes<lanes<typename Positions::Scalar>>(
      pairs, count, clear,
      [&](const PairCorners* few, std::uint8_t* flags) __attribute__((always_inline)) {
        find_clear_few<edges>(few, positions, distance, flags);
      });
}

}  // namespace

TAUT_MULTIVERSION void find_clear_edges(const PairCorners* pairs, Index count, const Vec3* x0,
                                        const Vec3* x1, double distance, std::uint8_t* clear) {
  find_all<true>(pairs, count, DoublePositions{x0, x1}, distance, clear);
}

TAUT_MULTIVERSION void find_clear_triangles(const PairCorners* pairs, Index count, const Vec3* x0,
                                            const Vec3* x1, double distance, std::uint8_t* clear) {
  find_all<false>(pairs, count, DoublePositions{x0, x1}, distance, clear);
}

TAUT_MULTIVERSION_AVX2 void find_clear_edges(const PairCorners* pairs, Index count,
                                             const FloatWay* ways, float distance,
                                             std::uint8_t* clear) {
  find_all<true>(pairs, count, FloatPositions{ways}, distance, clear);
}

TAUT_MULTIVERSION_AVX2 void find_clear_triangles(const PairCorners* pairs, Index count,
                                                 const FloatWay* ways, float distance,
                                                 std::uint8_t* clear) {
  find_all<false>(pairs, count, FloatPositions{ways}, distance, clear);
}

TAUT_MULTIVERSION_AVX2 void find_apart_all(const SegmentTriangle* pairs, Index count,
                                           const FloatWay* ways, float distance,
                                           std::uint8_t* apart) {
  for_lanes<lanes<float>>(pairs, count, apart,
                          [&](const SegmentTriangle* few, std::uint8_t* flags)
                              __attribute__((always_inline)) {
                                find_apart_few(few, FloatPositions{ways}, distance, flags);
                              });
}

void find_clear(const PairCorners* pairs, Index count, bool edges, const Vec3* x0, const Vec3* x1,
                double distance, std::uint8_t* clear) {
  edges ? find_clear_edges(pairs, count, x0, x1, distance, clear)
        : find_clear_triangles(pairs, count, x0, x1, distance, clear);
}

namespace {

// Of all finite positions.
struct Range {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  void add(const Vec3& x) {
    if (x.allFinite()) low = low.cwiseMin(x), high = high.cwiseMax(x);
  }
  Range& operator+=(const Range& other) {
    low = low.cwiseMin(other.low), high = high.cwiseMax(other.high);
    return *this;
  }
};

}  // namespace

void FloatWays::set(std::span<const Vec3> x0, std::span<const Vec3> x1) {
  ways_.resize(x0.size());
  const Range range =
      ordered_sum<Range>(static_cast<Index>(x0.size()), [&](Index begin, Index end) {
        Range part;
        for (Index v = begin; v < end; ++v) part.add(x0[v]), part.add(x1[v]);
        return part;
      });
  const Vec3 origin = 0.5 * range.low + 0.5 * range.high;
  // Both points of a pair may be off by this along each axis.
  coordinate_error_ = Precision<float>::u * (0.5 * range.high - 0.5 * range.low).maxCoeff();
  parallel_for(static_cast<Index>(x0.size()), 4096, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v)
      for (int i = 0; i < 3; ++i) {
        ways_[v].at[0][i] = static_cast<float>(x0[v][i] - origin[i]);
        ways_[v].at[1][i] = static_cast<float>(x1[v][i] - origin[i]);
      }
  });
}

float FloatWays::widened(double distance) const {
  // 2 sqrt(3) < 4; the rest is for rounding here.
  return static_cast<float>((distance + 4.0 * coordinate_error_) *
                            (1.0 + 8.0 * Precision<float>::u));
}

void FloatWays::find_clear(const PairCorners* pairs, Index count, bool edges, double distance,
                           std::uint8_t* clear) const {
  const float wanted = widened(distance);
  edges ? find_clear_edges(pairs, count, ways_.data(), wanted, clear)
        : find_clear_triangles(pairs, count, ways_.data(), wanted, clear);
}

void FloatWays::find_apart(const SegmentTriangle* pairs, Index count, std::uint8_t* apart) const {
  find_apart_all(pairs, count, ways_.data(), widened(0.0), apart);
}

}  // namespace taut::detail
