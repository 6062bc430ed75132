#pragma once
// All pairs of overlapping items of two box trees, or of one with itself, for
// contact/broad_phase.h. Private to contact.
//
// Each block of 64 items of the first tree, eight groups of eight, descends through the second down
// to the blocks that are near it; then groups meet groups, and items items. Each part of the result
// is that of a few blocks, so that parts do not depend on the number of threads.

#include <bit>
#include <limits>
#include <numeric>

#include "taut/base/parallel.h"
#include "taut/contact/detection/box_tree.h"
#include "taut/contact/detection/leaf_overlaps.h"

namespace taut::detail {

// Neighbouring chunks cost alike (crumpled here, flat there), so threads, which get runs of them,
// take them in a stride across the whole surface.
inline Index strided(Index k, Index count) {
  Index stride = static_cast<Index>(0.618 * count) | 1;
  while (std::gcd(stride, count) != 1) stride += 2;
  return static_cast<Index>(static_cast<Offset>(k) * stride % count);
}

// Eight groups of the second tree, and for each of eight groups of the first one those
// of them that it may meet.
struct Block {
  Index group;
  std::array<std::uint8_t, 8> masks;
};

// Items of the first tree have `first_corners` corners each, of the second `second_corners`.
template <int first_corners, int second_corners, class Pair, class MakePair>
class TreeQuery {
 public:
  TreeQuery(const BoxTree& first, const BoxTree& second, std::span<const std::uint8_t> moved,
            const MakePair& make_pair)
      : first_(first),
        second_(second),
        itself_(&first == &second),
        still_(first.still()),
        make_pair_(make_pair) {
    if (moved.empty()) return;
    moved_second_ = second.any_moved(moved);
    moved_first_ = itself_ ? moved_second_ : first.any_moved(moved);
  }

  // Pairs of the items below group p of the first tree's level 1. blocks: working memory.
  void run(Index p, std::vector<Block>& blocks, std::vector<Pair>& pairs) const {
    if (itself_ && restricted() && moved_first_[1][p] == 0) return;  // found from the other side
    find_blocks(p, blocks);
    for (Index lane = 0; lane < first_.lanes_used(1, p); ++lane) {
      const Index q = 8 * p + lane;
      const bool all_solid = first_.solid(1, p) >> lane & 1;
      const bool none_moved = restricted() && moved_first_[0][q] == 0;
      if (none_moved && itself_) continue;
      for (const Block& block : blocks) {
        Mask mask = block.masks[lane];
        if (all_solid) mask &= ~second_.solid(1, block.group);
        if (none_moved) mask &= moved_second_[1][block.group];
        if (itself_ && !restricted()) mask &= from(q, block.group);
        while (mask != 0) {  // from the highest lane down, as above the blocks
          const int below = 31 - std::countl_zero(mask);
          mask &= ~(1u << below);
          meet(q, block.group, below, pairs);
        }
      }
    }
  }

 private:
  bool restricted() const { return !moved_second_.empty(); }

  // Lanes of `group` with what is not before `other`, on the level of both: in a tree with itself,
  // those met this one on their own way.
  static Mask from(Index other, Index group) {
    const Index lane = other - 8 * group;
    return lane <= 0 ? 0xffu : lane < 8 ? 0xffu << lane : 0u;
  }

  // The groups of the second tree's level 1 that have something near group p of the first one's, in
  // ascending order.
  void find_blocks(Index p, std::vector<Block>& blocks) const {
    blocks.clear();
    const bool none_moved = restricted() && moved_first_[1][p] == 0;
    const MovingBox around =
        first_.height() > 2 ? box_of_lane(first_.group(2, p / 8), p % 8) : everything();
    struct Visit {
      int level;
      Index group;
    };
    Visit stack[8 * 12];  // 8^11 groups are more than an Index counts
    int depth = 0;
    stack[depth++] = {second_.height() - 1, 0};
    while (depth > 0) {
      const Visit visit = stack[--depth];
      if (visit.level == 1) {
        Block& block = blocks.emplace_back();
        block.group = visit.group;
        group_overlaps(first_.group(1, p), second_.group(1, visit.group), still_,
                       block.masks.data());
        continue;
      }
      Mask mask = overlapping(second_.group(visit.level, visit.group), around, still_);
      if (none_moved) mask &= moved_second_[visit.level][visit.group];
      if (itself_ && !restricted()) mask &= from(p >> (3 * (visit.level - 2)), visit.group);
      // The last pushed is visited first: so from the highest lane down.
      for (Mask left = mask; left != 0;) {
        const int lane = 31 - std::countl_zero(left);
        left &= ~(1u << lane);
        stack[depth++] = {visit.level - 1, 8 * visit.group + lane};
      }
    }
  }

  static MovingBox everything() {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    constexpr Box box{{-infinity, -infinity, -infinity, 0}, {infinity, infinity, infinity, 0}};
    return {{box, box}};
  }

  // The items of group q with those of the group g of the second tree that is in
  // lane `below` of `parent`.
  void meet(Index q, Index parent, int below, std::vector<Pair>& pairs) const {
    const Index g = 8 * parent + below;
    Mask lanes = 0xff;
    // pairs with another lane are found from their other item
    if (itself_ && restricted()) lanes &= moved_first_[0][q];
    std::array<std::uint8_t, 8> masks;
    lanes = leaf_overlaps<first_corners, second_corners>(first_.leaf(q), second_.leaf(g),
                                                         second_.group(1, parent), below, lanes,
                                                         still_, masks.data());
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      Mask mask = masks[lane];
      if (itself_) {
        const Mask after = q < g ? ~0u : q == g ? ~1u << lane : 0u;
        mask &= restricted() ? after | ~moved_second_[0][g] : after;
      } else if (restricted() && !(moved_first_[0][q] >> lane & 1)) {
        mask &= moved_second_[0][g];
      }
      if (first_.solid(0, q) >> lane & 1) mask &= ~second_.solid(0, g);
      const Index slot = 8 * q + lane;
      for (; mask != 0; mask &= mask - 1)
        pairs.push_back(
            make_pair_(first_.item(slot), second_.item(8 * g + std::countr_zero(mask))));
    }
  }

  const BoxTree& first_;
  const BoxTree& second_;
  bool itself_, still_;
  const MakePair& make_pair_;
  LevelMasks moved_first_, moved_second_;
};

constexpr Index blocks_per_part = 4;

// Parts of the list of pairs whose first item is in `first`.
inline Index parts_of(const BoxTree& first) {
  const Index blocks = (first.groups() + 7) / 8;
  return (blocks + blocks_per_part - 1) / blocks_per_part;
}

// use(part, pairs) for each part, from several threads.
template <int first_corners, int second_corners, class Pair, class MakePair, class Use>
void query(const BoxTree& first, const BoxTree& second, std::span<const std::uint8_t> moved,
           const MakePair& make_pair, const Use& use) {
  if (first.items() == 0 || second.items() == 0) return;
  const TreeQuery<first_corners, second_corners, Pair, MakePair> tree_query(first, second, moved,
                                                                            make_pair);
  const Index blocks = (first.groups() + 7) / 8, parts = parts_of(first);
  parallel_for(parts, 1, [&](Index begin, Index end) {
    std::vector<Block> near;
    std::vector<Pair> pairs;
    for (Index k = begin; k < end; ++k) {
      const Index part = strided(k, parts);
      pairs.clear();
      for (Index p = part * blocks_per_part; p < std::min(blocks, (part + 1) * blocks_per_part);
           ++p)
        tree_query.run(p, near, pairs);
      use(part, std::span<const Pair>(pairs));
    }
  });
}

}  // namespace taut::detail
