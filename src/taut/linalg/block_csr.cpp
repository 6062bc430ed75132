#include "taut/linalg/block_csr.h"

#include <algorithm>
#include <cassert>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"

namespace taut {

namespace {

// Rows per task: about 0.4 MB of a cloth matrix, enough to hide the cost of handing a task over.
constexpr Index rows_per_task = 256;

// A row's gathered x: 64 neighbours of 3 unknowns; longer rows are done in pieces of
// at most this many entries.
constexpr Index gather_capacity = 192;

void fill_layout(BlockPattern& p) {
  const Index n = p.rows();
  p.block_offset.resize(p.column.size());
  p.column_dof.resize(p.column.size());
  p.value_start.assign(static_cast<std::size_t>(n) + 1, 0);
  p.diagonal.assign(static_cast<std::size_t>(n), -1);
  p.uniform_dim = n > 0 ? p.dim(0) : 0;
  for (Index i = 0; i < n; ++i) {
    Index width = 0;
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
      assert(p.column[k] >= 0 && p.column[k] < n);
      p.block_offset[k] = width;
      p.column_dof[k] = p.dof_start[p.column[k]];
      width += p.dim(p.column[k]);
      if (p.column[k] == i) p.diagonal[i] = k;
    }
    assert(p.diagonal[i] >= 0);
    p.value_start[i + 1] = p.value_start[i] + Offset{width} * p.dim(i);
    if (p.dim(i) != p.uniform_dim) p.uniform_dim = 0;
  }
}

struct RowView {
  const Index* row_start;
  const Index* column;
  const Index* column_dof;
  const Index* block_offset;
  const Index* dof_start;
  const Offset* value_start;
  const double* values;
  Index dofs;
};

// Four doubles at any address.
using Four = double __attribute__((vector_size(32), aligned(8), may_alias));
TAUT_ALWAYS_INLINE const Four& four(const double* p) { return *reinterpret_cast<const Four*>(p); }
TAUT_ALWAYS_INLINE double sum_of(const Four& v) { return (v[0] + v[2]) + (v[1] + v[3]); }

// The x that a row meets, its neighbours' unknowns packed in `to`. Four are copied of each,
// whatever its dim: what is too much is written over by the next. Wants four unknowns behind each
// column_dof of the row.
TAUT_ALWAYS_INLINE void gather(const RowView& a, Index first, Index last, const double* x,
                               double* to) {
  for (Index k = first; k < last; ++k)
    *reinterpret_cast<Four*>(to + a.block_offset[k]) = four(x + a.column_dof[k]);
}

// s += the first `dim` rows of a panel times g. Two sums a row, so that one
// need not wait for the other.
template <int dim>
TAUT_ALWAYS_INLINE void row_product(const double* row, Index width, const double* g, Index length,
                                    double* s) {
  Four even[dim] = {}, odd[dim] = {};
  Index c = 0;
  for (; c + 8 <= length; c += 8) {
    const Four g0 = four(g + c), g1 = four(g + c + 4);
    for (int r = 0; r < dim; ++r) {
      even[r] += four(row + r * width + c) * g0;
      odd[r] += four(row + r * width + c + 4) * g1;
    }
  }
  if (c + 4 <= length) {
    for (int r = 0; r < dim; ++r) even[r] += four(row + r * width + c) * four(g + c);
    c += 4;
  }
  double rest[dim] = {};
  for (; c < length; ++c)
    for (int r = 0; r < dim; ++r) rest[r] += row[r * width + c] * g[c];
  for (int r = 0; r < dim; ++r) s[r] += sum_of(even[r] + odd[r]) + rest[r];
}

// Rows that are too long to be gathered at once, or too near the end of x.
template <int dim>
TAUT_ALWAYS_INLINE void row_product_in_pieces(const RowView& a, Index first, Index last,
                                              const double* row, Index width, const double* x,
                                              double* gathered, double* s) {
  Index k = first;
  for (Index piece = 0; piece < width;) {
    Index length = 0;
    for (; k < last; ++k) {
      const Index from = a.column_dof[k], d = a.dof_start[a.column[k] + 1] - from;
      if (length + d > gather_capacity) break;
      for (Index c = 0; c < d; ++c) gathered[length + c] = x[from + c];
      length += d;
    }
    row_product<dim>(row + piece, width, gathered, length, s);
    piece += length;
  }
}

// y_i = A_i x for a row of `dim` unknowns; returns x_i·y_i.
template <int dim>
TAUT_ALWAYS_INLINE double one_row(const RowView& a, Index i, const double* x, double* y,
                                  double* gathered) {
  const double* row = a.values + a.value_start[i];
  const Index width = static_cast<Index>(a.value_start[i + 1] - a.value_start[i]) / dim;
  const Index first = a.row_start[i], last = a.row_start[i + 1];
  double s[3] = {};
  if (width <= gather_capacity && a.column_dof[last - 1] + 4 <= a.dofs) {
    gather(a, first, last, x, gathered);
    row_product<dim>(row, width, gathered, width, s);
  } else {
    row_product_in_pieces<dim>(a, first, last, row, width, x, gathered, s);
  }
  double xax = 0.0;
  const Index dof = a.dof_start[i];
  for (int r = 0; r < dim; ++r) {
    y[dof + r] = s[r];
    xax += x[dof + r] * s[r];
  }
  return xax;
}

// Rows of blocks of up to 3x3; returns the sum of x_i·y_i over the rows.
TAUT_MULTIVERSION double rows_product_blocks(const RowView& a, Index begin, Index end,
                                             const double* x, double* y) {
  alignas(64) double gathered[gather_capacity + 4];
  double xax = 0.0;
  for (Index i = begin; i < end; ++i) {
    const Index dim = a.dof_start[i + 1] - a.dof_start[i];
    if (dim == 3)
      xax += one_row<3>(a, i, x, y, gathered);
    else if (dim == 2)
      xax += one_row<2>(a, i, x, y, gathered);
    else if (dim == 1)
      xax += one_row<1>(a, i, x, y, gathered);
  }
  return xax;
}

// How far ahead values are asked for, into the second-level cache.
constexpr Index prefetch_distance = 4096 / sizeof(double);

// The same where all blocks are 3x3, which needs fewer index lists. A row's x is gathered while the
// row before it is multiplied: what is read there in other pieces than it was written in must have
// arrived in the cache.
TAUT_MULTIVERSION double rows_product_3(const RowView& a, Index begin, Index end, const double* x,
                                        double* y) {
  alignas(64) double gathered[2][gather_capacity + 4];
  const auto is_short = [&](Index i) __attribute__((always_inline)) {
    const Index first = a.row_start[i], last = a.row_start[i + 1];
    return 3 * (last - first) <= gather_capacity && a.column_dof[last - 1] + 4 <= a.dofs;
  };
  const auto gather_row = [&](Index i) __attribute__((always_inline)) {
    double* to = gathered[i % 2];
    for (Index k = a.row_start[i]; k < a.row_start[i + 1]; ++k, to += 3)
      *reinterpret_cast<Four*>(to) = four(x + a.column_dof[k]);
  };
  double xax = 0.0;
  bool is_gathered = begin < end && is_short(begin);
  if (is_gathered) gather_row(begin);
  for (Index i = begin; i < end; ++i) {
    const bool is_next_gathered = i + 1 < end && is_short(i + 1);
    if (is_next_gathered) gather_row(i + 1);
    const double* row = a.values + a.value_start[i];
    const Index first = a.row_start[i], last = a.row_start[i + 1], width = 3 * (last - first);
    double s[3] = {};
    if (is_gathered) {
      for (Index k = 0; k < 3 * width; k += 8)
        __builtin_prefetch(row + prefetch_distance + k, 0, 2);
      row_product<3>(row, width, gathered[i % 2], width, s);
    } else {
      row_product_in_pieces<3>(a, first, last, row, width, x, gathered[i % 2], s);
    }
    for (Index r = 0; r < 3; ++r) {
      y[3 * i + r] = s[r];
      xax += x[3 * i + r] * s[r];
    }
    is_gathered = is_next_gathered;
  }
  return xax;
}

// The same for 1x1 blocks.
TAUT_MULTIVERSION double rows_product_1(const RowView& a, Index begin, Index end, const double* x,
                                        double* y) {
  double xax = 0.0;
  for (Index i = begin; i < end; ++i) {
    double s = 0.0;
    const double* v = a.values + a.value_start[i];
    const Index first = a.row_start[i], count = a.row_start[i + 1] - first;
    for (Index k = 0; k < count; ++k) s += v[k] * x[a.column[first + k]];
    y[i] = s;
    xax += x[i] * s;
  }
  return xax;
}

double rows_product(const BlockCsr& a, Index begin, Index end, const double* x, double* y) {
  const BlockPattern& p = *a.pattern;
  const RowView view{
      p.row_start.data(), p.column.data(),      p.column_dof.data(), p.block_offset.data(),
      p.dof_start.data(), p.value_start.data(), a.values.data(),     p.dofs()};
  if (p.uniform_dim == 1) return rows_product_1(view, begin, end, x, y);
  return p.uniform_dim == 3 ? rows_product_3(view, begin, end, x, y)
                            : rows_product_blocks(view, begin, end, x, y);
}

}  // namespace

Index BlockPattern::find(Index i, Index j) const {
  const auto begin = column.begin() + row_start[i], end = column.begin() + row_start[i + 1];
  const auto it = std::lower_bound(begin, end, j);
  return it != end && *it == j ? static_cast<Index>(it - column.begin()) : -1;
}

Offset BlockPattern::bytes() const {
  return static_cast<Offset>(sizeof(Index) *
                                 (dof_start.size() + row_start.size() + column.size() +
                                  column_dof.size() + block_offset.size() + diagonal.size()) +
                             sizeof(Offset) * value_start.size());
}

std::shared_ptr<const BlockPattern> make_pattern(std::vector<std::vector<Index>> columns,
                                                 std::span<const Index> dims) {
  assert(columns.size() == dims.size());
  std::vector<Index> row_start(columns.size() + 1, 0), column, dof_start(columns.size() + 1, 0);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    auto& row = columns[i];
    row.push_back(static_cast<Index>(i));
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    column.insert(column.end(), row.begin(), row.end());
    row_start[i + 1] = static_cast<Index>(column.size());
    dof_start[i + 1] = dof_start[i] + dims[i];
  }
  return make_pattern(std::move(row_start), std::move(column), std::move(dof_start));
}

std::shared_ptr<const BlockPattern> make_pattern(std::vector<std::vector<Index>> columns,
                                                 Index uniform_dim) {
  const std::vector<Index> dims(columns.size(), uniform_dim);
  return make_pattern(std::move(columns), dims);
}

std::shared_ptr<const BlockPattern> make_pattern(std::vector<Index> row_start,
                                                 std::vector<Index> column,
                                                 std::vector<Index> dof_start) {
  auto pattern = std::make_shared<BlockPattern>();
  pattern->row_start = std::move(row_start);
  pattern->column = std::move(column);
  pattern->dof_start = std::move(dof_start);
  fill_layout(*pattern);
  return pattern;
}

double BlockCsr::at(Index row_dof, Index column_dof) const {
  const auto& start = pattern->dof_start;
  const auto node_of = [&](Index dof) {
    return static_cast<Index>(std::upper_bound(start.begin(), start.end(), dof) - start.begin()) -
           1;
  };
  const Index i = node_of(row_dof), j = node_of(column_dof);
  const Index k = pattern->find(i, j);
  if (k < 0) return 0.0;
  return block(i, k)[(row_dof - start[i]) * pattern->width(i) + column_dof - start[j]];
}

void multiply(const BlockCsr& a, std::span<const double> x, std::span<double> y) {
  assert(static_cast<Index>(x.size()) == a.dofs() && static_cast<Index>(y.size()) == a.dofs());
  parallel_for(a.rows(), rows_per_task,
               [&](Index begin, Index end) { rows_product(a, begin, end, x.data(), y.data()); });
}

double multiply_dot(const BlockCsr& a, std::span<const double> x, std::span<double> y) {
  assert(static_cast<Index>(x.size()) == a.dofs() && static_cast<Index>(y.size()) == a.dofs());
  return ordered_sum(
      a.rows(),
      [&](Index begin, Index end) { return rows_product(a, begin, end, x.data(), y.data()); },
      rows_per_task, 1);
}

Offset multiply_bytes(const BlockCsr& a) {
  const BlockPattern& p = *a.pattern;
  return static_cast<Offset>(a.values.size() * sizeof(double) + p.column.size() * sizeof(Index)) +
         Offset{p.rows()} * static_cast<Offset>(sizeof(Index) + sizeof(Offset)) +
         Offset{2} * p.dofs() * static_cast<Offset>(sizeof(double));
}

std::vector<double> diagonal_of(const BlockCsr& a) {
  std::vector<double> diagonal(static_cast<std::size_t>(a.dofs()));
  const BlockPattern& p = *a.pattern;
  for (Index i = 0; i < p.rows(); ++i)
    for (Index r = 0; r < p.dim(i); ++r)
      diagonal[p.dof_start[i] + r] = a.block(i, p.diagonal[i])[r * p.width(i) + r];
  return diagonal;
}

}  // namespace taut
