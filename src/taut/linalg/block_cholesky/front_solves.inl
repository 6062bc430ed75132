// Packing and solves of front_kernels.h; included by front_kernels.inl inside its namespaces, whose
// vectors it uses.

// The packed panel. Its rows come in pieces of whole vectors, as a front's vector does; at a
// group's end and at the front's, parts of one.

constexpr Int line_bytes = 64;
template <class T>
constexpr Int line = line_bytes / static_cast<Int>(sizeof(T));
// Rows of the last piece are padded to this.
template <class T>
constexpr Int row_unit = lanes<T> < 4 ? lanes<T> : 4;
// How far ahead of their use packed panels are asked for, into the second-level cache: panels of
// different fronts lie one after the other.
template <class T>
constexpr Int prefetch_distance = 4096 / static_cast<Int>(sizeof(T));

// Asks for `count` elements at a distance from p.
template <class T>
TAUT_INLINE void prefetch_at(const T* p, Int distance, Int count) {
  for (Int k = 0; k < count; k += line<T>) __builtin_prefetch(p + distance + k, 0, 2);
}

constexpr Int rounded_up(Int n, Int unit) { return (n + unit - 1) / unit * unit; }

// Elements of a group of `width` pivots before row `end`: the triangle, the rows below, what fills
// the last cache line.
template <class T>
TAUT_INLINE Int group_size(Int width, Int end, Int rows) {
  const Int padded = rounded_up(rows, row_unit<T>);
  return rounded_up(width * (group + (padded > end ? padded - end : 0)), line<T>);
}

template <class T>
TAUT_INLINE Int first_width(const FrontShape& shape) {
  return group - shape.padding;
}

// Of all groups before the one that ends at `end`.
template <class T>
TAUT_INLINE std::int64_t group_offset(const FrontShape& shape, Int end) {
  std::int64_t offset = 0;
  for (Int e = group; e < end; e += group)
    offset += group_size<T>(e == group ? first_width<T>(shape) : group, e, shape.rows);
  return offset;
}

// Whole vectors are read of a piece that is less than one: the last may reach beyond the group.
template <class T>
std::int64_t packed_size(const FrontShape& shape) {
  const Int in_last = rounded_up(shape.rows, row_unit<T>) % lanes<T>;
  return group_offset<T>(shape, shape.columns + group) +
         (in_last > 0 ? rounded_up(lanes<T> - in_last, line<T>) : 0);
}

// Calls f with the width as a constant.
template <Int Width = group, class Function>
TAUT_INLINE void with_width(Int width, Function f) {
  if constexpr (Width == 1) {
    f.template operator()<1>();
  } else {
    if (width == Width) return f.template operator()<Width>();
    with_width<Width - 1>(width, f);
  }
}

// Walks over the rows end ... rows-1 in pieces that no vector's border cuts: whole(row, a) for
// whole vectors, part(row, low, stride, a) for parts of one, which begins at `row` and whose lanes
// low ... are the piece; a: the piece's first column, `stride`: from there to the next.
template <class T, Int Width, class Pointer, class Whole, class Part>
TAUT_INLINE void for_pieces(Int end, Int rows, Pointer a, Whole whole, Part part) {
  constexpr Int l = lanes<T>;
  if (rows <= end) return;
  Int row = end / l * l;
  const Int padded = rounded_up(rows, row_unit<T>);
  if (const Int low = end - row; low > 0) {
    const Int stride = (padded - row < l ? padded - row : l) - low;
    part(row, low, stride, a);
    a += Width * stride;
    row += l;
  }
  for (; row + l <= rows; row += l, a += Width * l) whole(row, a);
  if (row < rows) part(row, 0, padded - row, a);
}

// The same from the last piece to the first.
template <class T, Int Width, class Whole, class Part>
TAUT_INLINE void for_pieces_backward(Int end, Int rows, const T* a, Whole whole, Part part) {
  constexpr Int l = lanes<T>;
  if (rows <= end) return;
  const Int first = (end + l - 1) / l * l, padded = rounded_up(rows, row_unit<T>);
  Int row = rows / l * l;
  if (row < rows && row >= first) part(row, 0, padded - row, a + Width * (row - end));
  for (row -= l; row >= first; row -= l) whole(row, a + Width * (row - end));
  if (first > end) part(first - l, end - (first - l), (padded < first ? padded : first) - end, a);
}

template <class T>
TAUT_INLINE Mask<T> piece_mask(Int row, Int low, Int rows) {
  const Mask<T> lane = lane_numbers<T>();
  return (lane >= low) & (lane < rows - row);
}

// Goes down a panel's slabs: no multiplication for the next.
template <class T>
struct SlabCursor {
  const T* slab;
  Int width, columns;  // of this slab, of the last ones

  TAUT_INLINE SlabCursor(const FrontShape& shape, const T* panel, Int number)
      : slab(panel + shape.panel_offset(number)),
        width(shape.panel_width(number)),
        columns(shape.columns) {}
  TAUT_INLINE void next() {
    slab += width * slab_rows<T>;
    width = width + slab_rows<T> < columns ? width + slab_rows<T> : columns;
  }
};

// The group of columns first ... end-1; the cursor is at the slab of its own rows.
template <class T, Int Width>
TAUT_INLINE void pack_group(SlabCursor<T> cursor, Int first, Int end, Int rows, T* to) {
  constexpr Int r = slab_rows<T>, l = lanes<T>;
  const T* triangle = cursor.slab + first * r + (end - group) % r;
#pragma GCC unroll 8
  for (Int j = 0; j < Width; ++j)
    __builtin_memcpy(to + j * group, triangle + j * r, group * sizeof(T));
  for_pieces<T, Width>(
      end, rows, to + Width * group,
      [&](Int row, T* piece) __attribute__((always_inline)) {
        if (row % r == 0) cursor.next();
        const T* from = cursor.slab + first * r + row % r;
#pragma GCC unroll 8
        for (Int j = 0; j < Width; ++j) store(piece + j * l, load(from + j * r));
      },
      [&](Int row, Int low, Int stride, T* piece) __attribute__((always_inline)) {
        if (low == 0 && row % r == 0) cursor.next();
        const T* from = cursor.slab + first * r + row % r + low;
        for (Int i = 0; i < stride; i += row_unit<T>)
#pragma GCC unroll 8
          for (Int j = 0; j < Width; ++j)
            __builtin_memcpy(piece + j * stride + i, from + j * r + i, row_unit<T> * sizeof(T));
      });
}

template <class T>
void pack(const FrontShape& shape, const T* panel, T* packed, Int begin, Int end) {
  constexpr Int r = slab_rows<T>;
  if (begin >= end) return;
  T* to = packed + group_offset<T>(shape, begin + group);
  const Int rows = shape.rows;
  SlabCursor<T> cursor(shape, panel, begin / r);
  for (Int c = begin; c < end; c += group) {
    if (c > begin && c % r == 0) cursor.next();
    if (c == 0 && shape.padding > 0) {
      const Int width = first_width<T>(shape);
      with_width<group - 1>(width, [&]<Int Width>() __attribute__((always_inline)) {
        pack_group<T, Width>(cursor, shape.padding, group, rows, to);
      });
      to += group_size<T>(width, group, rows);
    } else {
      pack_group<T, group>(cursor, c, c + group, rows, to);
      to += group_size<T>(group, c + group, rows);
    }
  }
}

// y of the group's pivots -> x.
template <class T, Int Width>
TAUT_INLINE void forward_triangle(const T* triangle, T* y, T* x) {
  for (Int j = 0; j < Width; ++j) x[j] = y[j];
#pragma GCC unroll 8
  for (Int j = 0; j < Width; ++j) {
    x[j] *= triangle[j * group + j];
#pragma GCC unroll 8
    for (Int i = j + 1; i < Width; ++i) x[i] -= triangle[j * group + i] * x[j];
  }
  for (Int j = 0; j < Width; ++j) y[j] = x[j];
}

// The group of pivots before row `end`; from there on, y -= their columns times x.
template <class T, Int Width>
TAUT_INLINE void forward_group(const T* packed, Int end, Int rows, T* y) {
  prefetch_at(packed, prefetch_distance<T>, Width * group);
  T x[Width];
  forward_triangle<T, Width>(packed + group - Width, y + end - Width, x);
  Vector<T> factor[Width];
  for (Int j = 0; j < Width; ++j) factor[j] = Vector<T>{} + x[j];
  for_pieces<T, Width>(
      end, rows, packed + Width * group,
      [&](Int row, const T* a) __attribute__((always_inline)) {
        prefetch_at(a, prefetch_distance<T>, Width * lanes<T>);
        Vector<T> sum[2] = {load(y + row)};
#pragma GCC unroll 8
        for (Int j = 0; j < Width; ++j) {
          sum[j % 2] -= load(a + j * lanes<T>) * factor[j];
        }
        store<T>(y + row, sum[0] + sum[1]);
      },
      [&](Int row, Int low, Int stride, const T* a) __attribute__((always_inline)) {
        prefetch_at(a, prefetch_distance<T>, Width * stride);
        Vector<T> sum[2] = {};
#pragma GCC unroll 8
        for (Int j = 0; j < Width; ++j) {
          sum[j % 2] += load(a + j * stride - low) * factor[j];
        }
        store<T>(y + row,
                 load(y + row) - masked<T>(sum[0] + sum[1], piece_mask<T>(row, low, rows)));
      });
}

template <class T>
void forward(const FrontShape& shape, const T* packed, T* y) {
  if (shape.columns == 0) return;
  const Int width = first_width<T>(shape);
  with_width(width, [&]<Int Width>() __attribute__((always_inline)) {
    forward_group<T, Width>(packed, group, shape.rows, y);
  });
  packed += group_size<T>(width, group, shape.rows);
  for (Int end = 2 * group; end <= shape.columns; end += group) {
    forward_group<T, group>(packed, end, shape.rows, y);
    packed += group_size<T>(group, end, shape.rows);
  }
}

// Half of the lanes of two vectors seen as segments: of each segment its lower
// (Upper = 0) or upper (1) half.
template <class T, Int Segment, Int Upper, std::size_t... I>
TAUT_INLINE Vector<T> halves_of_segments(Vector<T> a, Vector<T> b, std::index_sequence<I...>) {
  constexpr Int half = Segment / 2;
  return __builtin_shufflevector(
      a, b, (static_cast<Int>(I) / half * Segment + Upper * half + static_cast<Int>(I) % half)...);
}

// x[k] -= the sum of v[k]'s lanes, for a group: a tree that halves the segments that belong to one
// k while it halves the number of vectors.
template <class T, Int Segment = lanes<T>, Int Count = group>
TAUT_INLINE void subtract_lane_sums(const Vector<T>* v, T* x) {
  if constexpr (Segment == 1) {
    for (Int k = 0; k < Count; ++k)
      for (Int i = 0; i < lanes<T> && k * lanes<T> + i < group; ++i) x[k * lanes<T> + i] -= v[k][i];
  } else {
    constexpr Int left = (Count + 1) / 2;
    constexpr auto all = std::make_index_sequence<lanes<T>>{};
    Vector<T> next[left];
    for (Int k = 0; k < left; ++k) {
      const Vector<T> a = v[2 * k], b = v[2 * k + 1 < Count ? 2 * k + 1 : 2 * k];
      next[k] = halves_of_segments<T, Segment, 0>(a, b, all) +
                halves_of_segments<T, Segment, 1>(a, b, all);
    }
    subtract_lane_sums<T, Segment / 2, left>(next, x);
  }
}

// x of the group's pivots, from the last to the first, each taken out of all before it at once: no
// sum waits for another.
template <class T, Int Width>
TAUT_INLINE void backward_triangle(const T* triangle, T* x) {
  T value[Width];
  for (Int j = 0; j < Width; ++j) value[j] = x[j];
#pragma GCC unroll 8
  for (Int i = Width - 1; i >= 0; --i) {
    value[i] *= triangle[i * group + i];
#pragma GCC unroll 8
    for (Int j = 0; j < i; ++j) value[j] -= triangle[j * group + i] * value[i];
  }
  for (Int j = 0; j < Width; ++j) x[j] = value[j];
}

template <class T, Int Width>
TAUT_INLINE void backward_group(const T* packed, Int end, Int rows, T* y) {
  Vector<T> sum[group] = {};
  constexpr Int first = group - Width;
  for_pieces_backward<T, Width>(
      end, rows, packed + Width * group,
      [&](Int row, const T* a) __attribute__((always_inline)) {
        prefetch_at(a, -prefetch_distance<T>, Width * lanes<T>);
        const Vector<T> factor = load(y + row);
#pragma GCC unroll 8
        for (Int j = Width - 1; j >= 0; --j) {
          sum[first + j] += load(a + j * lanes<T>) * factor;
        }
      },
      [&](Int row, Int low, Int stride, const T* a) __attribute__((always_inline)) {
        prefetch_at(a, -prefetch_distance<T>, Width * stride);
        const Mask<T> mask = piece_mask<T>(row, low, rows);
        const Vector<T> factor = masked<T>(load(y + row), mask);
#pragma GCC unroll 8
        for (Int j = Width - 1; j >= 0; --j) {
          sum[first + j] += masked<T>(load(a + j * stride - low), mask) * factor;
        }
      });
  prefetch_at(packed, -prefetch_distance<T>, Width * group);
  subtract_lane_sums<T>(sum, y + end - group);
  backward_triangle<T, Width>(packed + first, y + end - Width);
}

template <class T>
void backward(const FrontShape& shape, const T* packed, T* y) {
  if (shape.columns == 0) return;
  packed += group_offset<T>(shape, shape.columns + group);
  for (Int end = shape.columns; end > group; end -= group) {
    packed -= group_size<T>(group, end, shape.rows);
    backward_group<T, group>(packed, end, shape.rows, y);
  }
  const Int width = first_width<T>(shape);
  packed -= group_size<T>(width, group, shape.rows);
  with_width(width, [&]<Int Width>() __attribute__((always_inline)) {
    backward_group<T, Width>(packed, group, shape.rows, y);
  });
}
