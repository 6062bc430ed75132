#pragma once
// The dense arithmetic inside one front, compiled once per instruction set. A front is the
// lower triangle of a symmetric matrix of `rows` rows whose first `columns` columns
// (pivots) are eliminated:
//
//   L11 L11ᵀ = F11    L21 = F21 L11⁻ᵀ    U = -L21 L21ᵀ, to be added to the parent's front
//
//   panel    F11, F21, then L11, L21, in slabs of R = slab_rows rows, columns one after the other:
//            element (i, j) at panel_offset(i/R) + j R + i%R; L11's diagonal is stored inverted
//   update   U, in slabs: element (i, j) at update_offset(i/R) + (j-columns) R + i%R
//   packed   L11 and L21 once more, as the solves read them
//
// `columns` is a multiple of column_group, which divides R; both differ by instruction set and
// precision. No kernel allocates; all may be called from several threads on different data. Why
// these layouts: docs/design/block-cholesky.md.

#include <cstdint>

namespace taut {

struct FrontShape {
  std::int32_t columns = 0;  // pivots, padded to a multiple of column_group
  std::int32_t padding = 0;  // the first of them, which are the identity
  std::int32_t rows = 0;     // with the pivots
  std::int32_t slab_rows = 0;

  // These functions must never exist out of line: one compiled for a newer instruction set could be
  // linked into the plain build.
  [[gnu::always_inline]] std::int32_t slabs() const { return (rows + slab_rows - 1) / slab_rows; }
  [[gnu::always_inline]] std::int32_t first_update_slab() const { return columns / slab_rows; }
  [[gnu::always_inline]] std::int32_t panel_width(std::int32_t slab) const {
    const std::int32_t end = slab_rows * (slab + 1);
    return end < columns ? end : columns;
  }
  [[gnu::always_inline]] std::int64_t panel_offset(std::int32_t slab) const {
    const std::int64_t r = slab_rows,
                       full = slab < first_update_slab() ? slab : first_update_slab();
    return r * (r * (full * (full + 1) / 2) + (slab - full) * columns);
  }
  [[gnu::always_inline]] std::int64_t update_offset(std::int32_t slab) const {
    const std::int64_t r = slab_rows, first = first_update_slab(), b = slab;
    return r * (r * ((b * (b + 1) - first * (first + 1)) / 2) - (b - first) * columns);
  }
  // Of what the solves work on: whole SIMD registers, of at most a slab's column each, and room for
  // a few entries that are copied too many.
  [[gnu::always_inline]] std::int64_t vector_size() const {
    const std::int64_t r = slab_rows;
    return (rows + 4 + r - 1) / r * r;
  }
  [[gnu::always_inline]] std::int64_t panel_size() const { return panel_offset(slabs()); }
  [[gnu::always_inline]] std::int64_t update_size() const {
    return rows > columns ? update_offset(slabs()) : 0;
  }
  // An update is formed in tiles: of two slabs, counted from the last one up, R columns each, but
  // the last tile has all columns around the diagonal. `upper` is the first of the two, counted
  // from first_update_slab(), or -1 where that one is alone.
  [[gnu::always_inline]] static std::int32_t tiles_of_two(std::int32_t upper) {
    return upper < 0 ? 1 : upper + 1;
  }
  [[gnu::always_inline]] std::int32_t update_tiles() const {
    const std::int32_t n = slabs() - first_update_slab(), twos = n / 2;
    return rows <= columns ? 0 : n % 2 == 0 ? twos * twos : 1 + twos * (twos + 1);
  }
};

// How the rows of a child's front lie in its parent's. Both are in the order of elimination, so
// what a SIMD register of the parent's rows takes are consecutive rows of the child.
//
// `count` rows from `from` on are the parent's from `to` on, within either its
// pivots or its other rows.
struct RowRun {
  std::int32_t from = 0, to = 0, count = 0;
};

// The parent's rows to ... to+lanes-1: row to+i is the child's row from+lane[i], or
// none of its rows where lane[i] < 0. `from` and `to` are multiples of the register's
// lanes, and lane[i] < 2 lanes.
struct RowSpread {
  static constexpr std::int32_t most_lanes = 16;
  std::int32_t from = 0, to = 0, last = 0;  // last: the last of the child's rows here
  std::int8_t lane[most_lanes] = {};
};

struct BadPivot {
  std::int32_t column = -1;  // of the front, -1: all pivots are positive and finite
  double value = 0.0;        // the pivot before its square root is taken
};

template <class T>
struct FrontKernels {
  const char* instruction_set;
  std::int32_t lanes;  // of a SIMD register; divides slab_rows
  std::int32_t slab_rows;
  std::int32_t column_group;
  // columns eliminated before the next ones are touched; a multiple of slab_rows
  std::int32_t panel_columns;

  // Eliminates the pivots begin ... end-1 (at most panel_columns, begin a multiple of it) in the
  // slabs slab_begin ... slab_end-1. All earlier pivots are eliminated there, and the slabs that
  // hold the rows begin ... end-1 come first. Stops at a bad pivot.
  BadPivot (*eliminate)(const FrontShape& shape, T* panel, std::int32_t slab_begin,
                        std::int32_t slab_end, std::int32_t begin, std::int32_t end);

  // U = -L21 L21ᵀ for the tiles begin ... end-1 of update_tiles(), from the left to the diagonal,
  // then the next two slabs. Overwrites.
  void (*form_update)(const FrontShape& shape, const T* panel, T* update, std::int32_t begin,
                      std::int32_t end);

  // Adds a child's update to a front: in the columns of the runs, the rows of the spreads from the
  // diagonal on. `target` is the parent's panel if the columns are pivots there, else the parent's
  // update. What it holds above the diagonal is undefined afterwards.
  void (*add_update)(const FrontShape& child, const T* update, const RowRun* runs,
                     std::int32_t run_count, const RowSpread* spreads, std::int32_t spread_count,
                     const FrontShape& parent, T* target, bool target_is_panel);
  // Adds the rows of the spreads of a child's vector to its parent's.
  void (*add_rows)(const RowSpread* spreads, std::int32_t count, const T* from, T* to);

  // Elements of a packed panel, a multiple of a cache line; its begin must lie on one.
  std::int64_t (*packed_size)(const FrontShape& shape);
  // Packs the columns begin ... end-1, whole groups.
  void (*pack)(const FrontShape& shape, const T* panel, T* packed, std::int32_t begin,
               std::int32_t end);

  // x: vector_size() entries; those beyond `rows` may be anything.
  //   forward: x1 = L11⁻¹ x1, x2 -= L21 x1.  backward: x1 = L11⁻ᵀ (x1 - L21ᵀ x2)
  void (*forward)(const FrontShape& shape, const T* packed, T* x);
  void (*backward)(const FrontShape& shape, const T* packed, T* x);
};

}  // namespace taut
