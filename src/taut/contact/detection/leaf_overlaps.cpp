#include "taut/contact/detection/leaf_overlaps.h"

#include <bit>

#include "taut/base/simd.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // about calls that pass vectors: here all of them are inlined
#endif

namespace taut::detail {

namespace {

typedef float Floats __attribute__((vector_size(32)));
typedef std::int32_t Integers __attribute__((vector_size(32)));
typedef std::int64_t Longs __attribute__((vector_size(32)));

template <class Vector>
TAUT_ALWAYS_INLINE Vector load(const void* p) {
  Vector v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}

// Bit l of the result: lane l, whose bits are all alike.
TAUT_ALWAYS_INLINE Mask bits_of(const Integers& v) {
  const Integers bits = v & Integers{1, 2, 4, 8, 16, 32, 64, 128};
  const Longs pairs = (Longs)bits;
  const auto both = static_cast<std::uint64_t>(pairs[0] | pairs[1] | pairs[2] | pairs[3]);
  return static_cast<Mask>(both) | static_cast<Mask>(both >> 32);
}

template <int my_corners, int their_corners, bool still>
TAUT_ALWAYS_INLINE void overlaps(const LeafGroup& mine, const LeafGroup& theirs, Mask lanes, std::uint8_t* masks) {
  const BoxGroup &a = *mine.boxes, &b = *theirs.boxes;
  for (; lanes != 0; lanes &= lanes - 1) {
    const int l = std::countr_zero(lanes);
    Integers both = ~Integers{};
    for (int i = 0; i < 3; ++i) {
      Integers below = load<Floats>(b.low[0][i]) <= a.high[0][i][l], above = load<Floats>(b.high[0][i]) >= a.low[0][i][l];
      if constexpr (!still) {
        below |= load<Floats>(b.low[1][i]) <= a.high[1][i][l];
        above |= load<Floats>(b.high[1][i]) >= a.low[1][i][l];
      }
      both &= below & above;
    }
    for (int k = 0; k < their_corners; ++k)
      for (int i = 0; i < my_corners; ++i) both &= load<Integers>(theirs.corners[k].corner) != mine.corners[i].corner[l];
    masks[l] = static_cast<std::uint8_t>(bits_of(both));
  }
}

template <int my_corners, int their_corners>
TAUT_ALWAYS_INLINE void overlaps(const LeafGroup& mine, const LeafGroup& theirs, Mask lanes, bool still, std::uint8_t* masks) {
  still ? overlaps<my_corners, their_corners, true>(mine, theirs, lanes, masks)
        : overlaps<my_corners, their_corners, false>(mine, theirs, lanes, masks);
}

TAUT_MULTIVERSION_AVX2 void overlaps_of_boxes(const LeafGroup& mine, const LeafGroup& theirs, Mask lanes, bool still, std::uint8_t* masks) {
  overlaps<0, 0>(mine, theirs, lanes, still, masks);
}
TAUT_MULTIVERSION_AVX2 void overlaps_1_3(const LeafGroup& mine, const LeafGroup& theirs, Mask lanes, bool still, std::uint8_t* masks) {
  overlaps<1, 3>(mine, theirs, lanes, still, masks);
}
TAUT_MULTIVERSION_AVX2 void overlaps_2_2(const LeafGroup& mine, const LeafGroup& theirs, Mask lanes, bool still, std::uint8_t* masks) {
  overlaps<2, 2>(mine, theirs, lanes, still, masks);
}
TAUT_MULTIVERSION_AVX2 void overlaps_2_3(const LeafGroup& mine, const LeafGroup& theirs, Mask lanes, bool still, std::uint8_t* masks) {
  overlaps<2, 3>(mine, theirs, lanes, still, masks);
}

}  // namespace

void group_overlaps(const BoxGroup& mine, const BoxGroup& theirs, Mask lanes, bool still, std::uint8_t* masks) {
  overlaps_of_boxes({&mine, nullptr}, {&theirs, nullptr}, lanes, still, masks);
}

template <>
void leaf_overlaps<1, 3>(const LeafGroup& mine, const LeafGroup& theirs, Mask lanes, bool still, std::uint8_t* masks) {
  overlaps_1_3(mine, theirs, lanes, still, masks);
}
template <>
void leaf_overlaps<2, 2>(const LeafGroup& mine, const LeafGroup& theirs, Mask lanes, bool still, std::uint8_t* masks) {
  overlaps_2_2(mine, theirs, lanes, still, masks);
}
template <>
void leaf_overlaps<2, 3>(const LeafGroup& mine, const LeafGroup& theirs, Mask lanes, bool still, std::uint8_t* masks) {
  overlaps_2_3(mine, theirs, lanes, still, masks);
}

}  // namespace taut::detail
