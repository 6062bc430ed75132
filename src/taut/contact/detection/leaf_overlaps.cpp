#include "taut/contact/detection/leaf_overlaps.h"

#include <bit>

#include "taut/base/simd.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored \
    "-Wpsabi"  // about calls that pass vectors: here all of them are inlined
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

// The lanes of b whose boxes may overlap that of a's lane l.
template <bool still>
TAUT_ALWAYS_INLINE Integers near_lane(const BoxGroup& b, const BoxGroup& a, int l) {
  Integers both = ~Integers{};
  for (int i = 0; i < 3; ++i) {
    Integers below = load<Floats>(b.low[0][i]) <= a.high[0][i][l],
             above = load<Floats>(b.high[0][i]) >= a.low[0][i][l];
    if constexpr (!still) {
      below |= load<Floats>(b.low[1][i]) <= a.high[1][i][l];
      above |= load<Floats>(b.high[1][i]) >= a.low[1][i][l];
    }
    both &= below & above;
  }
  return both;
}

template <bool still>
TAUT_ALWAYS_INLINE void boxes(const BoxGroup& mine, const BoxGroup& theirs, std::uint8_t* masks) {
  for (int l = 0; l < 8; ++l)
    masks[l] = static_cast<std::uint8_t>(bits_of(near_lane<still>(theirs, mine, l)));
}

template <int my_corners, int their_corners, bool still>
TAUT_ALWAYS_INLINE Mask leaves(const LeafGroup& mine, const LeafGroup& theirs,
                               const BoxGroup& parent, int lane, Mask lanes, std::uint8_t* masks) {
  lanes &= bits_of(near_lane<still>(*mine.boxes, parent, lane));
  for (Mask left = lanes; left != 0; left &= left - 1) {
    const int l = std::countr_zero(left);
    Integers both = near_lane<still>(*theirs.boxes, *mine.boxes, l);
    for (int k = 0; k < their_corners; ++k)
      for (int i = 0; i < my_corners; ++i)
        both &= load<Integers>(theirs.corners[k].corner) != mine.corners[i].corner[l];
    masks[l] = static_cast<std::uint8_t>(bits_of(both));
  }
  return lanes;
}

template <int my_corners, int their_corners>
TAUT_ALWAYS_INLINE Mask leaves(const LeafGroup& mine, const LeafGroup& theirs,
                               const BoxGroup& parent, int lane, Mask lanes, bool still,
                               std::uint8_t* masks) {
  return still ? leaves<my_corners, their_corners, true>(mine, theirs, parent, lane, lanes, masks)
               : leaves<my_corners, their_corners, false>(mine, theirs, parent, lane, lanes, masks);
}

TAUT_MULTIVERSION_AVX2 void overlaps_of_boxes(const BoxGroup& mine, const BoxGroup& theirs,
                                              bool still, std::uint8_t* masks) {
  still ? boxes<true>(mine, theirs, masks) : boxes<false>(mine, theirs, masks);
}
TAUT_MULTIVERSION_AVX2 Mask overlaps_1_3(const LeafGroup& mine, const LeafGroup& theirs,
                                         const BoxGroup& parent, int lane, Mask lanes, bool still,
                                         std::uint8_t* masks) {
  return leaves<1, 3>(mine, theirs, parent, lane, lanes, still, masks);
}
TAUT_MULTIVERSION_AVX2 Mask overlaps_2_2(const LeafGroup& mine, const LeafGroup& theirs,
                                         const BoxGroup& parent, int lane, Mask lanes, bool still,
                                         std::uint8_t* masks) {
  return leaves<2, 2>(mine, theirs, parent, lane, lanes, still, masks);
}
TAUT_MULTIVERSION_AVX2 Mask overlaps_2_3(const LeafGroup& mine, const LeafGroup& theirs,
                                         const BoxGroup& parent, int lane, Mask lanes, bool still,
                                         std::uint8_t* masks) {
  return leaves<2, 3>(mine, theirs, parent, lane, lanes, still, masks);
}

}  // namespace

void group_overlaps(const BoxGroup& mine, const BoxGroup& theirs, bool still, std::uint8_t* masks) {
  overlaps_of_boxes(mine, theirs, still, masks);
}

template <>
Mask leaf_overlaps<1, 3>(const LeafGroup& mine, const LeafGroup& theirs, const BoxGroup& parent,
                         int lane, Mask lanes, bool still, std::uint8_t* masks) {
  return overlaps_1_3(mine, theirs, parent, lane, lanes, still, masks);
}
template <>
Mask leaf_overlaps<2, 2>(const LeafGroup& mine, const LeafGroup& theirs, const BoxGroup& parent,
                         int lane, Mask lanes, bool still, std::uint8_t* masks) {
  return overlaps_2_2(mine, theirs, parent, lane, lanes, still, masks);
}
template <>
Mask leaf_overlaps<2, 3>(const LeafGroup& mine, const LeafGroup& theirs, const BoxGroup& parent,
                         int lane, Mask lanes, bool still, std::uint8_t* masks) {
  return overlaps_2_3(mine, theirs, parent, lane, lanes, still, masks);
}

}  // namespace taut::detail
