#include "taut/contact/detection/box_tree.h"

#include <bit>
#include <limits>
#include <numeric>

#include "taut/base/parallel.h"

namespace taut::detail {

namespace {

constexpr Index refit_grain = 256;  // groups

// Sorts items so that each run of 8^k slots is compact: halves the range, at a multiple of the
// largest 8^k below its length, across the longest side of the items' centres.
void order_range(std::span<Index> items, std::span<const Vec3> centre) {
  const auto count = static_cast<Index>(items.size());
  if (count <= 8) {
    std::ranges::sort(items);
    return;
  }
  Index run = 8;
  while (run * 8 < count) run *= 8;
  const Index half = (count + run - 1) / run / 2 * run;
  Vec3 low = centre[items[0]], high = low;
  for (const Index i : items) {
    low = low.cwiseMin(centre[i]);
    high = high.cwiseMax(centre[i]);
  }
  Index axis;
  (high - low).maxCoeff(&axis);
  std::ranges::nth_element(items, items.begin() + half, [&](Index i, Index j) {
    const double x = centre[i][axis], y = centre[j][axis];
    return x < y || (x == y && i < j);
  });
  order_range(items.first(half), centre);
  order_range(items.subspan(half), centre);
}

}  // namespace

BoxTree::BoxTree(std::vector<Index> corners, int corners_per_item, std::span<const Vec3> positions,
                 std::span<const std::uint8_t> is_solid)
    : corners_per_item_(corners_per_item) {
  const std::size_t count = corners.size() / static_cast<std::size_t>(corners_per_item);
  const auto corner = [&](Index item, int k) {
    return corners[static_cast<std::size_t>(item) * corners_per_item + k];
  };
  std::vector<Vec3> centre(count, Vec3::Zero());
  for (Index i = 0; i < static_cast<Index>(count); ++i) {
    for (int k = 0; k < corners_per_item; ++k) centre[i] += positions[corner(i, k)];
    if (!centre[i].allFinite()) centre[i].setZero();
  }
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), Index{0});
  order_range(order_, centre);
  corners_.reserve(corners.size());
  for (const Index i : order_)
    for (int k = 0; k < corners_per_item; ++k) corners_.push_back(corner(i, k));

  corner_groups_.assign((count + 7) / 8 * static_cast<std::size_t>(corners_per_item),
                        {{-1, -1, -1, -1, -1, -1, -1, -1}});
  for (Index slot = 0; slot < static_cast<Index>(count); ++slot)
    for (int k = 0; k < corners_per_item; ++k)
      corner_groups_[slot / 8 * corners_per_item + k].corner[slot % 8] = this->corners(slot)[k];

  BoxGroup empty;
  for (int t = 0; t < 2; ++t)
    for (int i = 0; i < 3; ++i)
      for (int l = 0; l < 8; ++l)
        empty.low[t][i][l] = empty.high[t][i][l] = std::numeric_limits<float>::quiet_NaN();
  std::size_t boxes = count;
  do {
    boxes = (boxes + 7) / 8;
    levels_.emplace_back(boxes, empty);
  } while (boxes > 1 || levels_.size() < 2);
  solid_ = masks([&](Index slot) { return is_solid[this->corners(slot)[0]] != 0; }, true);
}

template <class OfItem>
LevelMasks BoxTree::masks(const OfItem& of_item, bool all) const {
  LevelMasks result(levels_.size());
  for (int level = 0; level < height(); ++level) {
    auto& here = result[level];
    here.resize(levels_[level].size());
    parallel_for(static_cast<Index>(here.size()), refit_grain, [&](Index begin, Index end) {
      for (Index g = begin; g < end; ++g)
        for (Index l = 0; l < lanes_used(level, g); ++l) {
          const Index below = 8 * g + l;
          bool bit;
          if (level == 0)
            bit = of_item(below);
          else if (all)
            bit = result[level - 1][below] == (1u << lanes_used(level - 1, below)) - 1;
          else
            bit = result[level - 1][below] != 0;
          if (bit) here[g] = static_cast<std::uint8_t>(here[g] | 1u << l);
        }
    });
  }
  return result;
}

LevelMasks BoxTree::any_moved(std::span<const std::uint8_t> moved) const {
  return masks(
      [&](Index slot) {
        bool any = false;
        for (int k = 0; k < corners_per_item_; ++k) any |= moved[corners(slot)[k]] != 0;
        return any;
      },
      false);
}

void BoxTree::fit_items(Index g, Mask lanes, int t, std::span<const MovingBox> vertices) {
  BoxGroup& group = levels_[0][g];
  for (; lanes != 0; lanes &= lanes - 1) {
    const int l = std::countr_zero(lanes);
    const Index* of_item = corners(8 * g + l);
    Box box = vertices[of_item[0]].at[t];
    for (int k = 1; k < corners_per_item_; ++k) {
      const Box& other = vertices[of_item[k]].at[t];
      for (int i = 0; i < 4; ++i) {
        box.low[i] = std::min(box.low[i], other.low[i]);
        box.high[i] = std::max(box.high[i], other.high[i]);
      }
    }
    for (int i = 0; i < 3; ++i) {
      group.low[t][i][l] = box.low[i];
      group.high[t][i][l] = box.high[i];
    }
  }
}

void BoxTree::fit_children(int level, Index g, Mask lanes, int t) {
  BoxGroup& group = levels_[level][g];
  for (; lanes != 0; lanes &= lanes - 1) {
    const int l = std::countr_zero(lanes);
    const Index below = 8 * g + l;
    const BoxGroup& child = levels_[level - 1][below];
    for (int i = 0; i < 3; ++i) {
      float low = child.low[t][i][0], high = child.high[t][i][0];
      for (Index k = 1; k < lanes_used(level - 1, below); ++k) {
        low = std::min(low, child.low[t][i][k]);
        high = std::max(high, child.high[t][i][k]);
      }
      group.low[t][i][l] = low;
      group.high[t][i][l] = high;
    }
  }
}

// The lanes lanes_of(level, g) of each group.
template <class LanesOf>
void BoxTree::fit(std::span<const MovingBox> vertices, const LanesOf& lanes_of) {
  for (int level = 0; level < height(); ++level)
    parallel_for(
        static_cast<Index>(levels_[level].size()), refit_grain, [&](Index begin, Index end) {
          for (Index g = begin; g < end; ++g) {
            const Mask lanes = lanes_of(level, g);
            if (lanes == 0) continue;
            for (int t = 0; t < (still_ ? 1 : 2); ++t)
              level == 0 ? fit_items(g, lanes, t, vertices) : fit_children(level, g, lanes, t);
          }
        });
}

void BoxTree::refit(std::span<const MovingBox> vertices, bool still) {
  still_ = still;
  if (items() == 0) return;
  fit(vertices, [&](int level, Index g) { return (1u << lanes_used(level, g)) - 1; });
}

void BoxTree::refit_moved(std::span<const MovingBox> vertices,
                          std::span<const std::uint8_t> moved) {
  if (items() == 0) return;
  const LevelMasks lanes = any_moved(moved);
  fit(vertices, [&](int level, Index g) {
    return Mask{lanes[static_cast<std::size_t>(level)][static_cast<std::size_t>(g)]};
  });
}

}  // namespace taut::detail
