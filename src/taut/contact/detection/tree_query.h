#pragma once
// All pairs of overlapping items of two box trees, or of one with itself, for contact/broad_phase.h. Private to contact.
//
// Each group of eight items of the first tree descends through the second. Chunks of such groups write lists of their own, which are joined
// in order, so the result does not depend on the number of threads.

#include <bit>
#include <numeric>

#include "taut/base/parallel.h"
#include "taut/contact/detection/box_tree.h"
#include "taut/contact/detection/leaf_overlaps.h"

namespace taut::detail {

// Neighbouring chunks cost alike (crumpled here, flat there), so threads, which get runs of them, take them in a stride across the whole
// surface.
inline Index strided(Index k, Index count) {
  Index stride = static_cast<Index>(0.618 * count) | 1;
  while (std::gcd(stride, count) != 1) stride += 2;
  return static_cast<Index>(static_cast<Offset>(k) * stride % count);
}

// Items of the first tree have `first_corners` corners each, of the second `second_corners`.
template <int first_corners, int second_corners, class Pair, class MakePair>
class TreeQuery {
 public:
  TreeQuery(const BoxTree& first, const BoxTree& second, std::span<const std::uint8_t> moved, const MakePair& make_pair)
      : first_(first), second_(second), itself_(&first == &second), still_(first.still()), make_pair_(make_pair) {
    if (moved.empty()) return;
    moved_second_ = second.any_moved(moved);
    moved_first_ = itself_ ? moved_second_ : first.any_moved(moved);
  }

  // Pairs of the items in group q of the first tree.
  void run(Index q, std::vector<Pair>& pairs) const {
    const bool all_solid = first_.solid(1, q / 8) >> (q % 8) & 1;
    const bool none_moved = restricted() && moved_first_[0][q] == 0;
    if (none_moved && itself_) return;
    const MovingBox around = box_of_lane(first_.group(1, q / 8), q % 8);
    struct Visit {
      int level;
      Index group;
    };
    Visit stack[8 * 12];  // 8^11 groups are more than an Index counts
    int depth = 0;
    stack[depth++] = {second_.height() - 1, 0};
    while (depth > 0) {
      const Visit visit = stack[--depth];
      Mask mask = overlapping(second_.group(visit.level, visit.group), around, still_);
      if (all_solid) mask &= ~second_.solid(visit.level, visit.group);
      if (none_moved) mask &= moved_second_[visit.level][visit.group];
      if (itself_ && !restricted()) {
        // Groups before q met q on their own way.
        const Index from = (q >> (3 * (visit.level - 1))) - 8 * visit.group;
        if (from > 0) mask &= from < 8 ? ~0u << from : 0u;
      }
      // The last pushed is visited first: so from the highest lane down.
      for (Mask left = mask; left != 0;) {
        const int lane = 31 - std::countl_zero(left);
        left &= ~(1u << lane);
        const Index below = 8 * visit.group + lane;
        if (visit.level > 1)
          stack[depth++] = {visit.level - 1, below};
        else
          meet(q, below, overlapping(first_.group(0, q), box_of_lane(second_.group(1, visit.group), lane), still_), pairs);
      }
    }
  }

 private:
  bool restricted() const { return !moved_second_.empty(); }

  // Those items in the given lanes of group q with the items of group g of the second tree.
  void meet(Index q, Index g, Mask lanes, std::vector<Pair>& pairs) const {
    if (itself_ && restricted()) lanes &= moved_first_[0][q];  // pairs with another lane are found from their other item
    std::array<std::uint8_t, 8> masks;
    leaf_overlaps<first_corners, second_corners>(first_.leaf(q), second_.leaf(g), lanes, still_, masks.data());
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
      for (; mask != 0; mask &= mask - 1) pairs.push_back(make_pair_(first_.item(slot), second_.item(8 * g + std::countr_zero(mask))));
    }
  }

  const BoxTree& first_;
  const BoxTree& second_;
  bool itself_, still_;
  const MakePair& make_pair_;
  LevelMasks moved_first_, moved_second_;
};

// found: one list a chunk, kept by the caller so that their memory is used again.
template <int first_corners, int second_corners, class Pair, class MakePair>
void query(const BoxTree& first, const BoxTree& second, std::span<const std::uint8_t> moved, std::vector<std::vector<Pair>>& found,
           std::vector<Pair>& pairs, const MakePair& make_pair) {
  pairs.clear();
  if (first.items() == 0 || second.items() == 0) return;
  constexpr Index groups_per_chunk = 32;
  const TreeQuery<first_corners, second_corners, Pair, MakePair> tree_query(first, second, moved, make_pair);
  const Index chunks = (first.groups() + groups_per_chunk - 1) / groups_per_chunk;
  found.resize(static_cast<std::size_t>(chunks));
  parallel_for(chunks, 1, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      const Index c = strided(k, chunks);
      found[c].clear();
      for (Index q = c * groups_per_chunk; q < std::min(first.groups(), (c + 1) * groups_per_chunk); ++q) tree_query.run(q, found[c]);
    }
  });
  std::size_t total = 0;
  for (const auto& list : found) total += list.size();
  pairs.reserve(total);
  for (const auto& list : found) pairs.insert(pairs.end(), list.begin(), list.end());
}

}  // namespace taut::detail
