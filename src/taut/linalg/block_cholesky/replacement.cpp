#include "taut/linalg/block_cholesky/replacement.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

namespace taut {

namespace {

// Multiplies A_ac in the block of two corners, counted a, b, c, d; only blocks that have a place.
constexpr float factor_of(int corner, int other) {
  return (corner + other) % 2 == 1 ? 1.0f : -1.0f;
}

struct Planned {
  Index block;  // of FactorLayout::row_value
  float factor;
  Replacement::Addend addend;
};

}  // namespace

Replacement plan_replacement(std::span<const Parallelogram> replaced, const BlockPattern& pattern,
                             const FactorLayout& layout) {
  std::vector<std::vector<Planned>> rows(static_cast<std::size_t>(pattern.rows()));
  for (const Parallelogram& p : replaced) {
    const Index corners[] = {p.a, p.b, p.c, p.d};
    for (int k = 0; k < 4; ++k) {
      const Index row = corners[k], place = layout.place[row];
      // A's block from the nearer row: it is read about now. Not from the last one, where nothing
      // may be read behind it.
      const bool from_c = p.c + 1 < pattern.rows() && std::abs(row - p.c) < std::abs(row - p.a);
      const Index source = from_c ? p.c : p.a;
      const Offset value =
          pattern.value_start[source] + pattern.block_offset[from_c ? p.opposite : p.block];
      for (int l = 0; l < 4; ++l) {
        const Index other = layout.place[corners[l]];
        if (other < place || (k != l && (k + l) % 2 == 0 && k % 2 == 0)) continue;
        const Index block =
            layout.row_start[row] + find_block(layout, place, other) - layout.block_start[place];
        rows[row].push_back(
            {block,
             factor_of(k, l),
             {static_cast<Index>(value - pattern.value_start[row]), pattern.width(source)}});
      }
    }
  }
  Replacement result;
  result.row_start.push_back(0);
  result.count.assign(layout.block.size(), 0);
  result.factor.assign(layout.block.size(), 0.0f);
  for (auto& row : rows) {
    std::ranges::stable_sort(row, {}, &Planned::block);
    for (const Planned& planned : row) {
      ++result.count[planned.block];
      assert(result.factor[planned.block] == 0.0f ||
             result.factor[planned.block] == planned.factor);
      result.factor[planned.block] = planned.factor;
      result.addend.push_back(planned.addend);
    }
    result.row_start.push_back(static_cast<Index>(result.addend.size()));
  }
  return result;
}

Offset Replacement::bytes() const {
  return static_cast<Offset>(addend.size() * sizeof(Addend) +
                             (row_start.size() + count.size() + factor.size()) * sizeof(Index));
}

}  // namespace taut
