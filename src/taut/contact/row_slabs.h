#pragma once
// In which order rows are met, and which of them at the same time: those that share no vertex.
// Space is cut into slabs across one axis; a row belongs to the slab that holds all its vertices,
// or to the boundary of the two slabs that do, or to the rest.
//
//   phase 0   one group a slab
//   phase 1   one group a boundary 0|1, 2|3, ...
//   phase 2   one group a boundary 1|2, 3|4, ...
//   phase 3   one group, the rest
//   phase 4   one group a slab: rows of one vertex and a solid
//   phase 5   one group: rows that came later, of collisions
//
// Groups of a phase may run side by side, each in its order; phases one after another. Groups
// depend on rows and positions only. Few rows are one slab. Why few slabs, and this order:
// docs/design/cloth-contact.md.

#include <array>
#include <span>
#include <vector>

#include "taut/base/types.h"

namespace taut {

class RowSlabs {
 public:
  using Vertices = std::array<Index, 4>;  // of a row; -1: fewer than four
  static constexpr Index slabs = 4, phases = 6, groups = 3 * slabs + 1;
  static constexpr Index fewest_rows = 1024;  // that are cut up

  // x: m, of all vertices.
  RowSlabs(std::span<const Vertices> rows, std::span<const Vec3> x);

  // Where row k goes: groups one after another, in each the order in which they were given. Rows
  // beyond these are phase 5.
  Index place(std::size_t k) const { return place_[k]; }
  std::size_t rows() const { return place_.size(); }
  // Groups of this phase are [first_group(phase), first_group(phase + 1)); rows of a group
  // [start(g), start(g + 1)), of the last all that come after.
  Index first_group(Index phase) const { return phase_[phase]; }
  Index start(Index group) const { return start_[group]; }

 private:
  std::array<Index, phases + 1> phase_{};
  std::array<Index, groups + 1> start_{};
  std::vector<Index> place_;
};

}  // namespace taut
