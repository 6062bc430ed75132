#include "taut/contact/row_slabs.h"

#include <algorithm>
#include <limits>

namespace taut {

namespace {

constexpr Index slabs = RowSlabs::slabs, boundaries = slabs - 1, even_boundaries = slabs / 2;
constexpr Index rest = slabs + boundaries, on_solids = rest + 1, late = on_solids + slabs;
static_assert(late + 1 == RowSlabs::groups);

// Slabs of vertices by their coordinate along one axis. Bins, so that no
// coordinate needs to be sorted.
class Slabs {
 public:
  Slabs(std::span<const RowSlabs::Vertices> rows, std::span<const Vec3> x) : x_(x) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vec3 low = Vec3::Constant(infinity), high = -low;
    for (const auto& row : rows) {
      low = low.cwiseMin(x[row[0]]);
      high = high.cwiseMax(x[row[0]]);
    }
    (high - low).maxCoeff(&axis_);
    low_ = low[axis_];
    per_metre_ = bins / (high[axis_] - low_);
    std::array<Index, bins> count{};
    for (const auto& row : rows) ++count[bin(row[0])];
    Offset before = 0;
    for (Index b = 0; b < bins; ++b) {
      slab_[b] = static_cast<Index>(before * slabs / std::ssize(rows));
      before += count[b];
    }
  }
  Index of(Index vertex) const { return slab_[bin(vertex)]; }

 private:
  static constexpr Index bins = 4096;
  // What is not a number is in the first.
  Index bin(Index vertex) const {
    const double b = (x_[vertex][axis_] - low_) * per_metre_;
    return b > 0.0 ? static_cast<Index>(std::min(b, bins - 1.0)) : 0;
  }

  std::span<const Vec3> x_;
  Index axis_ = 0;
  double low_ = 0.0, per_metre_ = 0.0;
  std::array<Index, bins> slab_{};
};

Index group_of(const RowSlabs::Vertices& row, const Slabs& slab) {
  Index first = slab.of(row[0]), last = first;
  if (row[1] < 0) return on_solids + first;
  for (std::size_t k = 1; k < 4 && row[k] >= 0; ++k) {
    first = std::min(first, slab.of(row[k]));
    last = std::max(last, slab.of(row[k]));
  }
  if (first == last) return first;
  if (last > first + 1) return rest;
  return slabs + (first % 2 == 0 ? first / 2 : even_boundaries + first / 2);
}

}  // namespace

RowSlabs::RowSlabs(std::span<const Vertices> rows, std::span<const Vec3> x) : place_(rows.size()) {
  phase_ = {0, slabs, slabs + even_boundaries, rest, on_solids, late, groups};
  if (std::ssize(rows) < fewest_rows) {
    for (std::size_t k = 0; k < rows.size(); ++k) place_[k] = rows[k][1] < 0 ? on_solids : 0;
  } else {
    const Slabs slab(rows, x);
    for (std::size_t k = 0; k < rows.size(); ++k) place_[k] = group_of(rows[k], slab);
  }
  for (const Index g : place_) ++start_[g + 1];
  for (Index g = 0; g < groups; ++g) start_[g + 1] += start_[g];
  std::array<Index, groups + 1> next = start_;
  for (Index& place : place_) place = next[place]++;
}

}  // namespace taut
