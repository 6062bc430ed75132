#pragma once
// A packed tree of axis-aligned boxes with eight children a node, for contact/broad_phase.h.
// Private to contact.
//
//   item         a vertex, an edge or a triangle, given by its corners (1, 2 or 3 vertices)
//   slot         an item's place in the tree: items that are near each other have near slots;
//                item = order[slot]
//   group        eight boxes side by side. levels[0][g] holds the items of slots 8g ... 8g+7;
//                levels[L][g] lane l is the box around group 8g+l of level L-1. The highest level
//                is one group; there are at least two levels
//   empty lane   the last group of a level may be partly empty: its boxes are NaN, which overlap
//                nothing
//   mask         bit l stands for lane l

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "taut/base/types.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace taut::detail {

struct alignas(16) Box {
  float low[4];  // x, y, z and one unused
  float high[4];
};

// At the start and at the end of a step.
struct MovingBox {
  Box at[2];
};

struct alignas(32) BoxGroup {
  float low[2][3][8];
  float high[2][3][8];
};

using Mask = std::uint32_t;  // of eight lanes

// The lanes of `group` that `box` may overlap at some time: not those that are on the same side of
// it along an axis at both ends, and so, since all corners move straight on, all the time. still:
// both ends are alike, and only the first is there.
inline Mask overlapping(const BoxGroup& group, const MovingBox& box, bool still) {
  Mask mask = 0;
#if defined(__SSE2__)
  const auto below = [&](int t, int i, int half) {
    return _mm_cmple_ps(_mm_load_ps(group.low[t][i] + half), _mm_set1_ps(box.at[t].high[i]));
  };
  const auto above = [&](int t, int i, int half) {
    return _mm_cmpge_ps(_mm_load_ps(group.high[t][i] + half), _mm_set1_ps(box.at[t].low[i]));
  };
  for (int half = 0; half < 8; half += 4) {
    __m128 both = _mm_castsi128_ps(_mm_set1_epi32(-1));
    for (int i = 0; i < 3; ++i) {
      __m128 low = below(0, i, half), high = above(0, i, half);
      if (!still)
        low = _mm_or_ps(low, below(1, i, half)), high = _mm_or_ps(high, above(1, i, half));
      both = _mm_and_ps(both, _mm_and_ps(low, high));
    }
    mask |= static_cast<Mask>(_mm_movemask_ps(both)) << half;
  }
#else
  for (int l = 0; l < 8; ++l) {
    bool both = true;
    for (int i = 0; i < 3; ++i) {
      bool below = group.low[0][i][l] <= box.at[0].high[i],
           above = group.high[0][i][l] >= box.at[0].low[i];
      if (!still)
        below |= group.low[1][i][l] <= box.at[1].high[i],
            above |= group.high[1][i][l] >= box.at[1].low[i];
      both &= below & above;
    }
    mask |= static_cast<Mask>(both) << l;
  }
#endif
  return mask;
}

// Eight vertex indices side by side: one corner of each item of a group, -1 in empty lanes.
struct alignas(32) CornerGroup {
  Index corner[8];
};

// Eight items: their boxes, and one CornerGroup a corner.
struct LeafGroup {
  const BoxGroup* boxes;
  const CornerGroup* corners;
};

inline MovingBox box_of_lane(const BoxGroup& group, int lane) {
  MovingBox box;
  for (int t = 0; t < 2; ++t)
    for (int i = 0; i < 3; ++i) {
      box.at[t].low[i] = group.low[t][i][lane];
      box.at[t].high[i] = group.high[t][i][lane];
    }
  return box;
}

// One bit a lane, at every level. A bit above level 0 says something of all (`and`) or of any
// (`or`) items below it.
using LevelMasks = std::vector<std::vector<std::uint8_t>>;

class BoxTree {
 public:
  // corners: `corners_per_item` vertices an item, one item after the other.
  BoxTree(std::vector<Index> corners, int corners_per_item, std::span<const Vec3> positions,
          std::span<const std::uint8_t> is_solid);

  // Boxes of all vertices, from which those of the items are made. still: only at the start, the
  // end is the same.
  void refit(std::span<const MovingBox> vertices, bool still);
  // The same where only these vertices' boxes have changed: one byte a vertex.
  void refit_moved(std::span<const MovingBox> vertices, std::span<const std::uint8_t> moved);
  bool still() const { return still_; }

  // Lanes with an item that has a corner marked in `moved`, one byte a vertex.
  LevelMasks any_moved(std::span<const std::uint8_t> moved) const;

  Index items() const { return static_cast<Index>(order_.size()); }
  int height() const { return static_cast<int>(levels_.size()); }
  Index groups() const { return static_cast<Index>(levels_[0].size()); }
  const BoxGroup& group(int level, Index g) const {
    return levels_[static_cast<std::size_t>(level)][static_cast<std::size_t>(g)];
  }
  // Lanes with nothing but solids.
  Mask solid(int level, Index g) const {
    return solid_[static_cast<std::size_t>(level)][static_cast<std::size_t>(g)];
  }
  Index item(Index slot) const { return order_[static_cast<std::size_t>(slot)]; }
  // Boxes and corners of group g of level 0.
  LeafGroup leaf(Index g) const {
    return {&levels_[0][static_cast<std::size_t>(g)],
            &corner_groups_[static_cast<std::size_t>(g * corners_per_item_)]};
  }
  // Of the item in a slot.
  const Index* corners(Index slot) const {
    return corners_.data() +
           static_cast<std::size_t>(slot) * static_cast<std::size_t>(corners_per_item_);
  }
  Index lanes_used(int level, Index g) const {
    const Index count =
        level == 0 ? items()
                   : static_cast<Index>(levels_[static_cast<std::size_t>(level) - 1].size());
    return std::min<Index>(8, count - 8 * g);
  }

 private:
  template <class OfItem>
  LevelMasks masks(const OfItem& of_item, bool all) const;
  void fit_items(Index g, Mask lanes, int t, std::span<const MovingBox> vertices);
  void fit_children(int level, Index g, Mask lanes, int t);
  template <class LanesOf>
  void fit(std::span<const MovingBox> vertices, const LanesOf& lanes_of);

  int corners_per_item_;
  bool still_ = false;
  std::vector<Index> order_;    // slot -> item
  std::vector<Index> corners_;  // by slot
  std::vector<CornerGroup> corner_groups_;
  std::vector<std::vector<BoxGroup>> levels_;
  LevelMasks solid_;
};

}  // namespace taut::detail
