// The kernels of front_kernels.h. Included by one source per instruction set, which names its
// namespace in TAUT_KERNELS; the register block follows from what the compiler may use. Nothing
// here may call an inline function of a library: see FrontShape.

#include <type_traits>
#include <utility>  // index_sequence only

#include "taut/linalg/block_cholesky/front_kernels.h"

namespace taut::TAUT_KERNELS {
namespace {

using Int = std::int32_t;

// The registers of one block of the update: R/lanes x G accumulators, R/lanes for a column of the
// first operand, one for the broadcast second operand. A block may be `wide` columns wide: eight
// accumulators hide the latency of two multiply-adds a cycle, wider slabs would only pad fronts
// more, most of which are small. Where there are two slabs, one below the other, a block takes them
// together if there are registers for it: then each number that is broadcast serves two
// multiply-adds, and it is these that take the time, not the loads (a quarter less). Where only
// half of a slab's rows are wanted, a block has half a slab's: with AVX-512 that is a narrower
// register, of which many processors take two at once. The elimination takes columns_at_once
// columns, to keep from storing what it needs next.
#if defined(__AVX512F__)
constexpr Int register_bytes = 64, block_vectors = 1, group = 4, wide = 8, most_slabs = 2;
#else
constexpr Int block_vectors = 2, group = 4, wide = 4, most_slabs = 1;
#if defined(__AVX2__)
constexpr Int register_bytes = 32;
#else
constexpr Int register_bytes = 16;
#endif
#endif

typedef float FloatVector __attribute__((vector_size(register_bytes)));
typedef double DoubleVector __attribute__((vector_size(register_bytes)));
typedef std::int32_t FloatMask __attribute__((vector_size(register_bytes)));
typedef std::int64_t DoubleMask __attribute__((vector_size(register_bytes)));
typedef float HalfFloatVector __attribute__((vector_size(register_bytes * block_vectors / 2)));
typedef double HalfDoubleVector __attribute__((vector_size(register_bytes * block_vectors / 2)));

template <class T>
struct Simd;
template <>
struct Simd<float> {
  using Vector = FloatVector;
  using Half = HalfFloatVector;
  using Mask = FloatMask;
};
template <>
struct Simd<double> {
  using Vector = DoubleVector;
  using Half = HalfDoubleVector;
  using Mask = DoubleMask;
};

template <class T>
using Vector = typename Simd<T>::Vector;
template <class T>
constexpr Int lanes = register_bytes / static_cast<Int>(sizeof(T));
template <class T>
constexpr Int slab_rows = block_vectors * lanes<T>;
template <class T>
constexpr Int panel_columns = 120 / slab_rows<T> * slab_rows<T>;
// An update's product goes over so many columns of three slabs at a time, or fewer: they stay in
// the first-level cache.
constexpr Int update_columns = 160;

#define TAUT_INLINE [[gnu::always_inline]] inline

template <class V, class T>
TAUT_INLINE V load_as(const T* p) {
  V v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}

template <class T>
TAUT_INLINE Vector<T> load(const T* p) {
  return load_as<Vector<T>>(p);
}

template <class V, class T>
TAUT_INLINE void store_as(T* p, V v) {
  __builtin_memcpy(p, &v, sizeof v);
}

template <class T>
TAUT_INLINE void store(T* p, Vector<T> v) {
  store_as(p, v);
}

template <class T>
using Mask = typename Simd<T>::Mask;

template <class T>
TAUT_INLINE Mask<T> lane_numbers() {
  Mask<T> numbers;
  for (Int i = 0; i < lanes<T>; ++i) numbers[i] = i;
  return numbers;
}

// Where the mask is set v, elsewhere 0, whatever v is there.
template <class T>
TAUT_INLINE Vector<T> masked(Vector<T> v, Mask<T> mask) {
  return (Vector<T>)((Mask<T>)v & mask);
}

template <bool condition, class A, class B>
struct Select {
  using Type = A;
};
template <class A, class B>
struct Select<false, A, B> {
  using Type = B;
};

// A register block: `Columns` columns of `Halves` halves of a slab, from its half `First` on; or of
// two whole slabs, the second of which lies `next` elements after the first.
template <class T, Int First = 0, Int Halves = 2, Int Columns = group, Int Slabs = 1>
struct Block {
  static_assert(Slabs == 1 || Halves == 2);
  static constexpr Int half = slab_rows<T> / 2, row = First * half;
  using Register = typename Select<Halves == 1, typename Simd<T>::Half, Vector<T>>::Type;
  static constexpr Int count = static_cast<Int>(sizeof(Register) / sizeof(T)),
                       in_slab = Halves * half / count, vectors = Slabs * in_slab;
  Register v[Columns][vectors];

  TAUT_INLINE static std::int64_t place(Int i, std::int64_t next) {
    return i / in_slab * next + row + i % in_slab * count;
  }
  TAUT_INLINE void load_from(const T* column, std::int64_t next = 0) {
    for (Int j = 0; j < Columns; ++j)
      for (Int i = 0; i < vectors; ++i)
        v[j][i] = load_as<Register>(column + j * slab_rows<T> + place(i, next));
  }
  TAUT_INLINE void store_to(T* column, std::int64_t next = 0) const {
    for (Int j = 0; j < Columns; ++j)
      for (Int i = 0; i < vectors; ++i)
        store_as(column + j * slab_rows<T> + place(i, next), v[j][i]);
  }
  TAUT_INLINE void clear() {
    for (Int j = 0; j < Columns; ++j)
      for (Int i = 0; i < vectors; ++i) v[j][i] = Register{};
  }
  // v -= A Bᵀ over k columns: a is a slab, or the first of two, b points at the group's first row
  // in another one.
  TAUT_INLINE void subtract_product(const T* a, const T* b, Int columns, std::int64_t next = 0) {
    for (Int k = 0; k < columns; ++k, a += slab_rows<T>, b += slab_rows<T>) {
      Register column[vectors];
      for (Int i = 0; i < vectors; ++i) column[i] = load_as<Register>(a + place(i, next));
#pragma GCC unroll 16
      for (Int j = 0; j < Columns; ++j) {
        const T factor = b[j];
#pragma GCC unroll 4
        for (Int i = 0; i < vectors; ++i) v[j][i] -= column[i] * factor;
      }
    }
  }
  // v = v L⁻ᵀ with the block's triangle of L (diagonal inverted), whose first row and
  // column are at `triangle`.
  TAUT_INLINE void solve_triangle(const T* triangle) {
#pragma GCC unroll 16
    for (Int j = 0; j < Columns; ++j) {
#pragma GCC unroll 4
      for (Int i = 0; i < vectors; ++i) v[j][i] *= triangle[j * slab_rows<T> + j];
#pragma GCC unroll 16
      for (Int l = j + 1; l < Columns; ++l)
#pragma GCC unroll 4
        for (Int i = 0; i < vectors; ++i) v[l][i] -= v[j][i] * triangle[j * slab_rows<T> + l];
    }
  }
};

// Calls f.template operator()<First, Halves>() with the halves of a slab that hold
// its rows begin ... end-1.
template <class T, class Function>
TAUT_INLINE void with_rows(Int begin, Int end, Function f) {
  constexpr Int half = slab_rows<T> / 2;
  if (begin >= half) {
    f.template operator()<1, 1>();
  } else if (end <= half) {
    f.template operator()<0, 1>();
  } else {
    f.template operator()<0, 2>();
  }
}

// As many columns at once as the registers hold beside what they are subtracted from.
template <class T, Int Slabs = 1>
constexpr Int columns_at_once = Slabs == 2           ? wide
                                : block_vectors == 1 ? slab_rows<T>
                                                     : group;

// Calls f.template operator()<Count>() with how many of `columns`, a multiple of the group, are
// taken at once.
template <class T, Int Count = columns_at_once<T>, class Function>
TAUT_INLINE void with_count(Int columns, Function f) {
  if constexpr (Count == group) {
    f.template operator()<Count>();
  } else {
    if (columns >= Count) return f.template operator()<Count>();
    with_count<T, Count - group>(columns, f);
  }
}

// The part of a panel that eliminate() works on.
template <class T>
struct Panel {
  const FrontShape& shape;
  T* values;
  T* slab(Int b) const { return values + shape.panel_offset(b); }
};

// Columns of a slab, or of two: subtracts the product over the columns 0 ... before-1, all of them
// eliminated, in pieces that stay in the first-level cache.
template <class T, Int Slabs>
void subtract_earlier_panels(const Panel<T>& panel, T* slab, std::int64_t next, Int before,
                             Int begin, Int end) {
  constexpr Int r = slab_rows<T>;
  for (Int k = 0; k < before; k += panel_columns<T>)
    for (Int c = begin; c < end; c += columns_at_once<T, Slabs>)
      with_count<T, columns_at_once<T, Slabs>>(
          end - c, [&]<Int Count>() __attribute__((always_inline)) {
            Block<T, 0, 2, Count, Slabs> block;
            block.load_from(slab + c * r, next);
            block.subtract_product(slab + k * r, panel.slab(c / r) + c % r + k * r,
                                   panel_columns<T>, next);
            block.store_to(slab + c * r, next);
          });
}

// The columns begin ... end-1 of a slab, or of two, that lie left of its diagonal block: product,
// over the columns from `from` on, and triangular solve in one pass.
template <class T, Int Slabs>
void solve_columns(const Panel<T>& panel, T* slab, std::int64_t next, Int from, Int begin,
                   Int end) {
  constexpr Int r = slab_rows<T>;
  for (Int c = begin; c < end; c += columns_at_once<T, Slabs>) {
    const T* pivot_rows = panel.slab(c / r) + c % r;
    with_count<T, columns_at_once<T, Slabs>>(
        end - c, [&]<Int Count>() __attribute__((always_inline)) {
          Block<T, 0, 2, Count, Slabs> block;
          block.load_from(slab + c * r, next);
          block.subtract_product(slab + from * r, pivot_rows + from * r, c - from, next);
          block.solve_triangle(pivot_rows + c * r);
          block.store_to(slab + c * r, next);
        });
  }
}

// Lane `Lane` of a slab's column in all lanes.
template <class T, Int Lane>
TAUT_INLINE Vector<T> broadcast(const Vector<T>* column) {
  return __builtin_shuffle(column[Lane / lanes<T>], Mask<T>{} + Lane % lanes<T>);
}

// 1 / sqrt of each.
template <class T>
TAUT_INLINE Vector<T> inverse_square_roots(Vector<T> v) {
  Vector<T> roots;
  for (Int i = 0; i < lanes<T>; ++i) {
    if constexpr (sizeof(T) == 4) {
      roots[i] = __builtin_sqrtf(v[i]);
    } else {
      roots[i] = __builtin_sqrt(v[i]);
    }
  }
  return T(1) / roots;
}

// `Count` columns of the diagonal block, from its column `First` on, with all rows of the slab, in
// registers: the product over the columns from `from` on, then L D Lᵀ, whose chain of operations
// from pivot to pivot is a quotient, a product and a subtraction long, and at the end the square
// roots of all pivots at once.
template <class T, Int First, Int Count>
TAUT_INLINE void factor_in_registers(T* slab, Int from, Int diagonal, BadPivot& bad) {
  constexpr Int r = slab_rows<T>;
  constexpr auto all = std::make_index_sequence<Count>{};
  T* first = slab + (diagonal + First) * r;
  Block<T, 0, 2, Count> block;
  block.load_from(first);
  block.subtract_product(slab + from * r, slab + from * r + First, diagonal + First - from);
  constexpr Int pivot_vectors = (Count + lanes<T> - 1) / lanes<T>;
  Vector<T> pivots[pivot_vectors];
  for (Int i = 0; i < pivot_vectors; ++i) pivots[i] = Vector<T>{} + T(1);
  const auto eliminate_column = [&]<std::size_t J>() __attribute__((always_inline)) {
    const Vector<T> pivot = broadcast<T, First + J>(block.v[J]), inverse = T(1) / pivot;
    Vector<T>& its_own = pivots[J / lanes<T>];
    its_own = lane_numbers<T>() == Int(J) % lanes<T> ? pivot : its_own;
    const auto subtract_from = [&]<std::size_t K>() __attribute__((always_inline)) {
      if constexpr (K > J) {
        const Vector<T> factor = broadcast<T, First + K>(block.v[J]) * inverse;
        for (Int i = 0; i < block_vectors; ++i) block.v[K][i] -= block.v[J][i] * factor;
      }
    };
    [&]<std::size_t... K>(std::index_sequence<K...>)
        __attribute__((always_inline)) { (subtract_from.template operator()<K>(), ...); }(all);
  };
  [&]<std::size_t... J>(std::index_sequence<J...>)
      __attribute__((always_inline)) { (eliminate_column.template operator()<J>(), ...); }(all);
  Vector<T> scales[pivot_vectors];
  for (Int i = 0; i < pivot_vectors; ++i) scales[i] = inverse_square_roots<T>(pivots[i]);
  const auto scale_column = [&]<std::size_t J>() __attribute__((always_inline)) {
    const Vector<T> scale = broadcast<T, J>(scales);
    for (Int i = 0; i < block_vectors; ++i) {
      const Mask<T> below = lane_numbers<T>() - (First + Int(J) - i * lanes<T>);
      block.v[J][i] = masked<T>(below == 0 ? scale : block.v[J][i] * scale, below >= 0);
    }
  };
  [&]<std::size_t... J>(std::index_sequence<J...>)
      __attribute__((always_inline)) { (scale_column.template operator()<J>(), ...); }(all);
  block.store_to(first);
  constexpr T largest = sizeof(T) == 4 ? T(__FLT_MAX__) : T(__DBL_MAX__);
  for (Int j = 0; j < Count && bad.column < 0; ++j)
    if (const T pivot = pivots[j / lanes<T>][j % lanes<T>]; !(pivot > T(0) && pivot <= largest))
      bad.column = diagonal + First + j, bad.value = static_cast<double>(pivot);
}

// The columns from `diagonal` to end-1, those of the slab's diagonal block; the product starts at
// column `from`.
template <class T, Int First = 0>
TAUT_INLINE void factor_columns(T* slab, Int from, Int diagonal, Int end, BadPivot& bad) {
  with_count<T>(end - diagonal - First, [&]<Int Count>() __attribute__((always_inline)) {
    factor_in_registers<T, First, Count>(slab, from, diagonal, bad);
    if constexpr (First + Count < slab_rows<T> && Count == columns_at_once<T>)
      if (bad.column < 0 && diagonal + First + Count < end)
        factor_columns<T, First + Count>(slab, from, diagonal, end, bad);
  });
}

// The pivots begin ... end-1 in one slab, where those before `left` have been.
template <class T>
BadPivot eliminate_slab(const Panel<T>& panel, Int b, Int begin, Int left, Int end) {
  constexpr Int r = slab_rows<T>;
  T* slab = panel.slab(b);
  const Int diagonal = r * b, stop = end < diagonal + r ? end : diagonal + r;
  if (begin > 0) subtract_earlier_panels<T, 1>(panel, slab, 0, begin, left, stop);
  solve_columns<T, 1>(panel, slab, 0, begin, left, stop < diagonal ? stop : diagonal);
  BadPivot bad;
  if (stop > diagonal) factor_columns<T>(slab, begin, diagonal, stop, bad);
  return bad;
}

template <class T>
BadPivot eliminate(const FrontShape& shape, T* values, Int slab_begin, Int slab_end, Int begin,
                   Int end) {
  constexpr Int r = slab_rows<T>;
  const Panel<T> panel{shape, values};
  for (Int b = slab_begin; b < slab_end; b += most_slabs) {
    const Int last = b + most_slabs < slab_end ? b + most_slabs : slab_end;
    Int left = begin;
    if constexpr (most_slabs == 2) {
      if (const Int common = end < r * b ? end : r * b; last == b + 2 && common > begin) {
        T* slab = panel.slab(b);
        const std::int64_t next = panel.slab(b + 1) - slab;
        if (begin > 0) subtract_earlier_panels<T, 2>(panel, slab, next, begin, begin, common);
        solve_columns<T, 2>(panel, slab, next, begin, begin, common);
        left = common;
      }
    }
    for (Int own = b; own < last && left < end; ++own)
      if (const BadPivot bad = eliminate_slab(panel, own, begin, left, end); bad.column >= 0)
        return bad;
  }
  return {};
}

// One R x R tile of the update, or on the diagonal its lower part: the rows and columns that the
// front has. Or one in each of two slabs, off the diagonal.
template <class T, Int Slabs = 1>
void form_tile(const FrontShape& shape, const T* panel, T* update, Int row_slab, Int column_slab) {
  constexpr Int r = slab_rows<T>;
  const T* rows = panel + shape.panel_offset(row_slab);
  const T* others = panel + shape.panel_offset(column_slab);
  T* out = update + shape.update_offset(row_slab);
  const std::int64_t next =
      Slabs == 2 ? shape.panel_offset(row_slab + 1) - shape.panel_offset(row_slab) : 0;
  const std::int64_t next_out =
      Slabs == 2 ? shape.update_offset(row_slab + 1) - shape.update_offset(row_slab) : 0;
  const bool is_diagonal = row_slab == column_slab;
  const Int first = r * column_slab > shape.columns ? r * column_slab : shape.columns,
            end_row = shape.rows - r * row_slab;
  const Int last = r * (column_slab + 1) < shape.rows ? r * (column_slab + 1) : shape.rows;
  // Pieces of one length; without columns there is one, which sets the update to zero.
  const Int pieces = shape.columns > 0 ? (shape.columns + update_columns - 1) / update_columns : 1;
  const Int piece = (shape.columns + pieces - 1) / pieces;
  for (Int p = 0, k = 0; p < pieces; ++p, k += piece) {
    const Int count = shape.columns - k < piece ? shape.columns - k : piece;
    const auto form_columns = [&]<Int Columns>(Int c) __attribute__((always_inline)) {
      const auto form_block = [&]<Int First, Int Halves>() __attribute__((always_inline)) {
        Block<T, First, Halves, Columns, Slabs> block;
        T* column = out + (c - shape.columns) * r;
        k == 0 ? block.clear() : block.load_from(column, next_out);
        block.subtract_product(rows + k * r, others + k * r + c % r, count, next);
        block.store_to(column, next_out);
      };
      if constexpr (Slabs == 2) {
        form_block.template operator()<0, 2>();
      } else {
        with_rows<T>(is_diagonal ? c % r : 0, end_row, form_block);
      }
    };
    Int c = first;
    for (; c % wide != 0; c += group) form_columns.template operator()<group>(c);
    for (; c + group < last; c += wide) form_columns.template operator()<wide>(c);
    if (c < last) form_columns.template operator()<group>(c);
  }
}

// Slabs in twos from the last one up, so that the first may be alone: tile after tile, then what is
// around the diagonal.
template <class T>
void form_update(const FrontShape& shape, const T* panel, T* update, Int begin, Int end) {
  const Int first = shape.first_update_slab(), slabs = shape.slabs();
  Int upper = (slabs - first) % 2 == 0 ? first : first - 1;
  for (Int before = 0; before < end; upper += 2) {
    const Int lower = upper + 1, tiles = FrontShape::tiles_of_two(upper - first);
    for (Int t = begin > before ? begin - before : 0; t < tiles && before + t < end; ++t) {
      const Int column = first + t;
      if (t == tiles - 1) {
        if (upper >= first)
          form_tile(shape, panel, update, upper, upper),
              form_tile(shape, panel, update, lower, upper);
        form_tile(shape, panel, update, lower, lower);
      } else if (most_slabs == 2 && 2 * (shape.rows - slab_rows<T> * lower) > slab_rows<T>) {
        form_tile<T, most_slabs>(shape, panel, update, upper, column);
      } else {
        form_tile(shape, panel, update, upper, column),
            form_tile(shape, panel, update, lower, column);
      }
    }
    before += tiles;
  }
}

// Rows of a child, spread over a register of its parent's.
template <class T>
struct Spread {
  Mask<T> lane, is_taken;

  TAUT_INLINE explicit Spread(const RowSpread& rows) {
    std::remove_reference_t<decltype(lane[0])> numbers[lanes<T>];
    for (Int i = 0; i < lanes<T>; ++i) numbers[i] = rows.lane[i];
    __builtin_memcpy(&lane, numbers, sizeof lane);
    is_taken = lane >= 0;
  }
  // Of the register at `from`, and the one at `next`.
  TAUT_INLINE Vector<T> of(const T* from) const {
    return masked<T>(__builtin_shuffle(load(from), lane), is_taken);
  }
  TAUT_INLINE Vector<T> of(const T* from, const T* next) const {
    return masked<T>(__builtin_shuffle(load(from), load(next), lane), is_taken);
  }
};

// Calls f(source) with what takes a spread's rows from a register and, if there are rows of two,
// from the next one.
template <class T, class Function>
TAUT_INLINE void with_sources(const RowSpread& rows, Function f) {
  const Spread<T> spread(rows);
  if (rows.last < rows.from + lanes<T>) {
    f([&](const T* from, const T*) __attribute__((always_inline)) { return spread.of(from); });
  } else {
    f([&](const T* from, const T* next)
          __attribute__((always_inline)) { return spread.of(from, next); });
  }
}

template <class T>
void add_update(const FrontShape& child, const T* update, const RowRun* runs, Int run_count,
                const RowSpread* spreads, Int spread_count, const FrontShape& parent, T* target,
                bool target_is_panel) {
  constexpr Int r = slab_rows<T>;
  // Divisions by a constant.
  const FrontShape small{child.columns, child.padding, child.rows, r},
      large{parent.columns, parent.padding, parent.rows, r};
  const auto rows_of = [&](Int row) __attribute__((always_inline)) {
    return update + small.update_offset(row / r) + row % r - child.columns * r;
  };
  for (const RowSpread* rows = spreads; rows < spreads + spread_count; ++rows) {
    const T *first = rows_of(rows->from), *second = rows_of(rows->from + lanes<T>);
    T* sums = target + rows->to % r +
              (target_is_panel ? large.panel_offset(rows->to / r)
                               : large.update_offset(rows->to / r) - parent.columns * r);
    with_sources<T>(*rows, [&](auto source) __attribute__((always_inline)) {
      for (const RowRun* run = runs; run < runs + run_count && run->from <= rows->last; ++run) {
        const Int left = rows->last + 1 - run->from, count = run->count < left ? run->count : left;
        const T *from = first + run->from * r, *next = second + run->from * r;
        T* sum = sums + run->to * r;
        for (Int j = 0; j < count; ++j, from += r, next += r, sum += r)
          store<T>(sum, load(sum) + source(from, next));
      }
    });
  }
}

template <class T>
void add_rows(const RowSpread* spreads, Int count, const T* from, T* to) {
  for (const RowSpread* rows = spreads; rows < spreads + count; ++rows)
    with_sources<T>(*rows, [&](auto source) __attribute__((always_inline)) {
      const T* first = from + rows->from;
      store<T>(to + rows->to, load(to + rows->to) + source(first, first + lanes<T>));
    });
}

#include "taut/linalg/block_cholesky/front_solves.inl"

template <class T>
constexpr FrontKernels<T> kernels_of(const char* name) {
  static_assert(lanes<T> <= RowSpread::most_lanes);
  return {name,          lanes<T>,        slab_rows<T>,   group,        panel_columns<T>,
          &eliminate<T>, &form_update<T>, &add_update<T>, &add_rows<T>, &packed_size<T>,
          &pack<T>,      &forward<T>,     &backward<T>};
}

}  // namespace

extern const FrontKernels<float> float_kernels = kernels_of<float>(TAUT_KERNELS_NAME);
extern const FrontKernels<double> double_kernels = kernels_of<double>(TAUT_KERNELS_NAME);

}  // namespace taut::TAUT_KERNELS
