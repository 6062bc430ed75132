#include "taut/linalg/block_remainder.h"

#include <cassert>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"

namespace taut {

namespace {

constexpr Index rows_per_task = 512;
constexpr Index overread = 3;  // entries behind a block's last row that a load of four takes in

using Four = double __attribute__((vector_size(32), aligned(8), may_alias));
using Mask = long long __attribute__((vector_size(32)));
TAUT_ALWAYS_INLINE const Four& four(const double* p) { return *reinterpret_cast<const Four*>(p); }

struct View {
  const Index *row_start, *column_dof, *column_dim, *dof_start;
  const Offset* value_start;
  const double* values;
};

// E's row i of three unknowns times c, blocks of 3x3: lane by lane, summed at the end.
template <bool lumped>
TAUT_ALWAYS_INLINE void row_product_3(const View& e, Index i, const double* c, double* product) {
  Four sum[3] = {};
  const double* own = c + 3 * i;
  const Four mine = {own[0], own[1], own[2], 0.0};
  for (Index k = e.row_start[i]; k < e.row_start[i + 1]; ++k) {
    const double *block = e.values + Offset{9} * k, *from = c + e.column_dof[k];
    Four x = {from[0], from[1], from[2], 0.0};
    if constexpr (lumped) x -= mine;
    for (Index r = 0; r < 3; ++r) sum[r] += four(block + 3 * r) * x;
  }
  for (Index r = 0; r < 3; ++r) product[r] = (sum[r][0] + sum[r][2]) + sum[r][1];
}

TAUT_ALWAYS_INLINE void row_product(const View& e, Index i, Index rows, const double* c, double* product) {
  for (Index r = 0; r < rows; ++r) product[r] = 0.0;
  for (Index k = e.row_start[i]; k < e.row_start[i + 1]; ++k)
    for (Index r = 0; r < rows; ++r)
      for (Index j = 0; j < e.column_dim[k]; ++j) product[r] += e.values[e.value_start[k] + e.column_dim[k] * r + j] * c[e.column_dof[k] + j];
}

enum class Rows { of_three, of_three_lumped, of_any };

template <Rows kind>
TAUT_ALWAYS_INLINE double advance_rows(const View& e, Index begin, Index end, double beta, const double* r, const double* c, double* p,
                                       double* q) {
  double energy = 0.0;
  for (Index i = begin; i < end; ++i) {
    const Index dof = kind == Rows::of_any ? e.dof_start[i] : 3 * i, rows = kind == Rows::of_any ? e.dof_start[i + 1] - dof : 3;
    double product[3];
    if constexpr (kind == Rows::of_any) {
      row_product(e, i, rows, c, product);
    } else {
      row_product_3<kind == Rows::of_three_lumped>(e, i, c, product);
    }
    for (Index j = 0; j < rows; ++j) {
      p[dof + j] = r[dof + j] + beta * p[dof + j];
      q[dof + j] = p[dof + j] + product[j];
      energy += c[dof + j] * q[dof + j];
    }
  }
  return energy;
}

TAUT_MULTIVERSION double advance_3(const View& e, Index begin, Index end, double beta, const double* r, const double* c, double* p, double* q) {
  return advance_rows<Rows::of_three>(e, begin, end, beta, r, c, p, q);
}

TAUT_MULTIVERSION double advance_3_lumped(const View& e, Index begin, Index end, double beta, const double* r, const double* c, double* p,
                                          double* q) {
  return advance_rows<Rows::of_three_lumped>(e, begin, end, beta, r, c, p, q);
}

double advance_any(const View& e, Index begin, Index end, double beta, const double* r, const double* c, double* p, double* q) {
  return advance_rows<Rows::of_any>(e, begin, end, beta, r, c, p, q);
}

}  // namespace

void BlockRemainder::analyze(std::shared_ptr<const BlockPattern> pattern, std::span<const std::uint8_t> mask) {
  const BlockPattern& p = *pattern;
  assert(static_cast<Index>(mask.size()) == p.blocks());
  row_start_.assign(1, 0);
  for (auto* list : {&column_dof_, &column_dim_}) list->clear();
  source_.clear(), value_start_.assign(1, 0);
  for (Index i = 0; i < p.rows(); ++i) {
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
      if (mask[k] || k == p.diagonal[i]) continue;
      column_dof_.push_back(p.column_dof[k]);
      column_dim_.push_back(p.dim(p.column[k]));
      source_.push_back(p.value_start[i] + p.block_offset[k]);
      value_start_.push_back(value_start_.back() + Offset{p.dim(i)} * column_dim_.back());
    }
    row_start_.push_back(static_cast<Index>(source_.size()));
  }
  values_.assign(static_cast<std::size_t>(value_start_.back()) + overread, 0.0);
  pattern_ = std::move(pattern);
}

void BlockRemainder::update(const BlockCsr& a) {
  parallel_for(a.rows(), rows_per_task, [&](Index begin, Index end) { update_rows(a, begin, end); });
}

void BlockRemainder::update_rows(const BlockCsr& a, Index begin, Index end) {
  assert(a.pattern == pattern_);
  const BlockPattern& p = *pattern_;
  for (Index i = begin; i < end; ++i) {
    const Index rows = p.dim(i), width = p.width(i);
    for (Index k = row_start_[i]; k < row_start_[i + 1]; ++k) {
      const double* from = a.values.data() + source_[k];
      double* to = values_.data() + value_start_[k];
      if (p.uniform_dim == 3) {
        for (Index r = 0; r < 3; ++r)
          for (Index c = 0; c < 3; ++c) to[3 * r + c] = from[r * width + c];
      } else {
        for (Index r = 0; r < rows; ++r)
          for (Index c = 0; c < column_dim_[k]; ++c) *to++ = from[r * width + c];
      }
    }
  }
}

double BlockRemainder::advance(bool lumped, double beta, std::span<const double> r, std::span<const double> c, std::span<double> p,
                               std::span<double> q) const {
  const View view{row_start_.data(), column_dof_.data(), column_dim_.data(), pattern_->dof_start.data(), value_start_.data(), values_.data()};
  assert(!lumped || pattern_->uniform_dim == 3);
  const auto rows = lumped ? advance_3_lumped : pattern_->uniform_dim == 3 ? advance_3 : advance_any;
  return ordered_sum(
      pattern_->rows(), [&](Index begin, Index end) { return rows(view, begin, end, beta, r.data(), c.data(), p.data(), q.data()); },
      rows_per_task, 1);
}

Offset BlockRemainder::bytes() const {
  return static_cast<Offset>(values_.size() * sizeof(double) + source_.size() * 2 * sizeof(Offset) +
                             (row_start_.size() + 2 * column_dof_.size()) * sizeof(Index));
}

}  // namespace taut
