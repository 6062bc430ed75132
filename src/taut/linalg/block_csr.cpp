#include "taut/linalg/block_csr.h"

#include <algorithm>
#include <cassert>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"

namespace taut {

namespace {

// Rows per task: about 0.4 MB of a cloth matrix, enough to hide the cost of handing a task over.
constexpr Index rows_per_task = 256;

// A row's gathered x: 64 neighbours of 3 unknowns; longer rows are done in pieces of this many entries.
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
  const Index* dof_start;
  const Offset* value_start;
  const double* values;
};

// y_i = A_i x for rows of blocks of up to 3x3; returns sum of x_i·y_i over the rows. Rows whose neighbours all have 3 unknowns gather without
// asking each for its dim: nearly all rows of a cloth that is held here and there.
TAUT_MULTIVERSION double rows_product_blocks(const RowView& a, Index begin, Index end, const double* x, double* y) {
  alignas(64) double gathered[gather_capacity];
  double xax = 0.0;
  for (Index i = begin; i < end; ++i) {
    const Index dof = a.dof_start[i], dim = a.dof_start[i + 1] - dof;
    if (dim == 0) continue;
    const double* row = a.values + a.value_start[i];
    const Index width = static_cast<Index>((a.value_start[i + 1] - a.value_start[i]) / dim);
    const Index last = a.row_start[i + 1];
    const bool whole = width == 3 * (last - a.row_start[i]);
    double s0 = 0.0, s1 = 0.0, s2 = 0.0;
    Index k = a.row_start[i];
    for (Index piece = 0; piece < width;) {
      Index length = 0;
      if (whole) {
        for (; k < last && length < gather_capacity; ++k, length += 3) {
          const double* from = x + a.column_dof[k];
          gathered[length] = from[0], gathered[length + 1] = from[1], gathered[length + 2] = from[2];
        }
      } else {
        for (; k < last; ++k) {
          const Index from = a.column_dof[k], d = a.dof_start[a.column[k] + 1] - from;
          if (length + d > gather_capacity) break;
          for (Index c = 0; c < d; ++c) gathered[length + c] = x[from + c];
          length += d;
        }
      }
      // A row of fewer than three unknowns repeats its first instead: one loop for all.
      const double* p0 = row + piece;
      const double* p1 = dim > 1 ? p0 + width : p0;
      const double* p2 = dim > 2 ? p1 + width : p0;
#pragma omp simd reduction(+ : s0, s1, s2)
      for (Index c = 0; c < length; ++c) {
        const double g = gathered[c];
        s0 += p0[c] * g;
        s1 += p1[c] * g;
        s2 += p2[c] * g;
      }
      piece += length;
    }
    const double s[3] = {s0, s1, s2};
    for (Index r = 0; r < dim; ++r) {
      y[dof + r] = s[r];
      xax += x[dof + r] * s[r];
    }
  }
  return xax;
}

// The same for 1x1 blocks.
TAUT_MULTIVERSION double rows_product_1(const RowView& a, Index begin, Index end, const double* x, double* y) {
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
  const RowView view{p.row_start.data(), p.column.data(), p.column_dof.data(), p.dof_start.data(), p.value_start.data(), a.values.data()};
  return p.uniform_dim == 1 ? rows_product_1(view, begin, end, x, y) : rows_product_blocks(view, begin, end, x, y);
}

}  // namespace

Index BlockPattern::find(Index i, Index j) const {
  const auto begin = column.begin() + row_start[i], end = column.begin() + row_start[i + 1];
  const auto it = std::lower_bound(begin, end, j);
  return it != end && *it == j ? static_cast<Index>(it - column.begin()) : -1;
}

Offset BlockPattern::bytes() const {
  return static_cast<Offset>(sizeof(Index) * (dof_start.size() + row_start.size() + column.size() + column_dof.size() + block_offset.size() + diagonal.size()) +
                             sizeof(Offset) * value_start.size());
}

std::shared_ptr<const BlockPattern> make_pattern(std::vector<std::vector<Index>> columns, std::span<const Index> dims) {
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

std::shared_ptr<const BlockPattern> make_pattern(std::vector<std::vector<Index>> columns, Index uniform_dim) {
  const std::vector<Index> dims(columns.size(), uniform_dim);
  return make_pattern(std::move(columns), dims);
}

std::shared_ptr<const BlockPattern> make_pattern(std::vector<Index> row_start, std::vector<Index> column, std::vector<Index> dof_start) {
  auto pattern = std::make_shared<BlockPattern>();
  pattern->row_start = std::move(row_start);
  pattern->column = std::move(column);
  pattern->dof_start = std::move(dof_start);
  fill_layout(*pattern);
  return pattern;
}

double BlockCsr::at(Index row_dof, Index column_dof) const {
  const auto& start = pattern->dof_start;
  const auto node_of = [&](Index dof) { return static_cast<Index>(std::upper_bound(start.begin(), start.end(), dof) - start.begin()) - 1; };
  const Index i = node_of(row_dof), j = node_of(column_dof);
  const Index k = pattern->find(i, j);
  if (k < 0) return 0.0;
  return block(i, k)[(row_dof - start[i]) * pattern->width(i) + column_dof - start[j]];
}

void multiply(const BlockCsr& a, std::span<const double> x, std::span<double> y) {
  assert(static_cast<Index>(x.size()) == a.dofs() && static_cast<Index>(y.size()) == a.dofs());
  parallel_for(a.rows(), rows_per_task, [&](Index begin, Index end) { rows_product(a, begin, end, x.data(), y.data()); });
}

double multiply_dot(const BlockCsr& a, std::span<const double> x, std::span<double> y) {
  assert(static_cast<Index>(x.size()) == a.dofs() && static_cast<Index>(y.size()) == a.dofs());
  return ordered_sum(a.rows(), [&](Index begin, Index end) { return rows_product(a, begin, end, x.data(), y.data()); });
}

Offset multiply_bytes(const BlockCsr& a) {
  const BlockPattern& p = *a.pattern;
  return static_cast<Offset>(a.values.size() * sizeof(double) + p.column.size() * sizeof(Index)) +
         Offset{p.rows()} * static_cast<Offset>(sizeof(Index) + sizeof(Offset)) + Offset{2} * p.dofs() * static_cast<Offset>(sizeof(double));
}

std::vector<double> diagonal_of(const BlockCsr& a) {
  std::vector<double> diagonal(static_cast<std::size_t>(a.dofs()));
  const BlockPattern& p = *a.pattern;
  for (Index i = 0; i < p.rows(); ++i)
    for (Index r = 0; r < p.dim(i); ++r) diagonal[p.dof_start[i] + r] = a.block(i, p.diagonal[i])[r * p.width(i) + r];
  return diagonal;
}

}  // namespace taut
