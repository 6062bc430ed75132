#include "taut/linalg/block_remainder.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "taut/base/flush_subnormals.h"
#include "taut/base/parallel.h"
#include "taut/base/simd.h"
#include "taut/linalg/small_block.h"

namespace taut {

namespace {

constexpr Index rows_per_task = 512;
constexpr Index overread = 3;  // entries behind a block's last row that a load of four takes in

using Four = double __attribute__((vector_size(32), aligned(8), may_alias));
using FourSingle = float __attribute__((vector_size(16), aligned(4), may_alias));

using Term = BlockRemainder::Term;
using Corner = BlockRemainder::Corner;

TAUT_ALWAYS_INLINE void add_three(const double* x, Four& to) { to += Four{x[0], x[1], x[2], 0.0}; }

// Row by row, lane by lane.
TAUT_ALWAYS_INLINE void add_product(const float* block, const Four& x, Four (&sum)[3]) {
  for (Index r = 0; r < 3; ++r) sum[r] += __builtin_convertvector(*reinterpret_cast<const FourSingle*>(block + 3 * r), Four) * x;
}

}  // namespace

// E's rows as they are now.
struct BlockRemainder::Rows {
  const Index *row_start, *row_end, *corner_start;  // corner_start: null where nothing is replaced
  const Term* term;
  const Corner* corner;
  const float* values;

  TAUT_ALWAYS_INLINE void product(Index i, const double* c, double* result) const {
    Four sum[3] = {};
    Four own = {};
    add_three(c + 3 * i, own);
    for (Index k = row_start[i]; k < row_end[i]; ++k) {
      Four x = -own;
      add_three(c + term[k].column_dof, x);
      add_product(values + Offset{9} * term[k].block, x, sum);
    }
    if (corner_start)
      for (const Corner* at = corner + corner_start[i]; at < corner + corner_start[i + 1]; ++at) {
        Four x = own, sides = {};
        add_three(c + at->opposite_dof, x);
        for (const Index dof : at->side_dof) add_three(c + dof, sides);
        x -= sides;
        add_product(values + Offset{9} * at->block, x, sum);
      }
    for (Index r = 0; r < 3; ++r) result[r] = (sum[r][0] + sum[r][2]) + sum[r][1];
  }
};

namespace {

TAUT_MULTIVERSION double advance_rows(const BlockRemainder::Rows& rows, Index begin, Index end, double beta, const double* r, const double* c,
                                      double* p, double* q) {
  double energy = 0.0;
  for (Index i = begin; i < end; ++i) {
    double product[3];
    rows.product(i, c, product);
    for (Index j = 3 * i; j < 3 * i + 3; ++j) {
      p[j] = r[j] + beta * p[j];
      q[j] = p[j] + product[j - 3 * i];
      energy += c[j] * q[j];
    }
  }
  return energy;
}

TAUT_ALWAYS_INLINE void add_block(const float* block, FourSingle (&sum)[3]) {
  for (Index r = 0; r < 3; ++r) sum[r] += *reinterpret_cast<const FourSingle*>(block + 3 * r);
}

TAUT_ALWAYS_INLINE double squared_norm(const FourSingle (&block)[3]) {
  Four sum = {};
  for (Index r = 0; r < 3; ++r) {
    const Four row = __builtin_convertvector(block[r], Four);
    sum += row * row;
  }
  return (sum[0] + sum[2]) + sum[1];
}

// Of the rows, squared.
TAUT_MULTIVERSION BlockRemainder::Ratios largest_ratios(const BlockRemainder::Rows& rows, Index begin, Index end, const double* masses) {
  BlockRemainder::Ratios largest;
  for (Index i = begin; i < end; ++i) {
    const double weight = 1.0 / (masses[i] * masses[i]);
    FourSingle dropped[3] = {}, replaced[3] = {};
    for (Index k = rows.row_start[i]; k < rows.row_end[i]; ++k) add_block(rows.values + Offset{9} * rows.term[k].block, dropped);
    const double ratio = weight * squared_norm(dropped);
    largest.dropped = ratio > largest.dropped ? ratio : largest.dropped;
    if (!rows.corner_start) continue;
    for (const Corner* at = rows.corner + rows.corner_start[i]; at < rows.corner + rows.corner_start[i + 1]; ++at)
      add_block(rows.values + Offset{9} * at->block, replaced);
    const double other = weight * squared_norm(replaced);
    largest.replaced = other > largest.replaced ? other : largest.replaced;
  }
  return largest;
}

}  // namespace

BlockRemainder::Rows BlockRemainder::rows() const {
  return {row_start_.data(), replaced_ ? row_split_.data() : row_start_.data() + 1, replaced_ ? corner_start_.data() : nullptr,
          term_.data(),      corner_.data(),                                        values_.data()};
}

void BlockRemainder::analyze(std::shared_ptr<const BlockPattern> pattern, std::span<const std::uint8_t> mask,
                             std::span<const Parallelogram> replaceable) {
  const BlockPattern& p = *pattern;
  assert(static_cast<Index>(mask.size()) == p.blocks() && p.uniform_dim == 3);
  std::vector<std::uint8_t> is_replaceable(mask.size(), 0);
  for (const Parallelogram& of : replaceable) is_replaceable[of.block] = is_replaceable[of.opposite] = 1;
  std::vector<Index> copied(mask.size(), -1);
  copy_start_.assign(1, 0);
  copy_.clear();
  row_start_.assign(1, 0);
  row_split_.clear();
  term_.clear();
  for (Index i = 0; i < p.rows(); ++i) {
    for (Index k = p.diagonal[i] + 1; k < p.row_start[i + 1]; ++k) {
      if (mask[k]) continue;
      copied[k] = copied[p.find(p.column[k], i)] = static_cast<Index>(copy_.size());
      copy_.push_back(p.block_offset[k]);
    }
    copy_start_.push_back(static_cast<Index>(copy_.size()));
  }
  for (Index i = 0; i < p.rows(); ++i) {
    for (const std::uint8_t last : {0, 1}) {
      if (last) row_split_.push_back(static_cast<Index>(term_.size()));
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
        if (!mask[k] && k != p.diagonal[i] && is_replaceable[k] == last) term_.push_back({copied[k], p.column_dof[k]});
    }
    row_start_.push_back(static_cast<Index>(term_.size()));
  }
  values_.assign(9 * copy_.size() + overread, 0.0f);

  const auto corners = [](const Parallelogram& of) { return std::array{of.a, of.b, of.c, of.d}; };
  corner_start_.assign(static_cast<std::size_t>(p.rows()) + 1, 0);
  for (const Parallelogram& of : replaceable)
    for (const Index i : corners(of)) ++corner_start_[i + 1];
  for (Index i = 0; i < p.rows(); ++i) corner_start_[i + 1] += corner_start_[i];
  corner_.resize(4 * replaceable.size());
  std::vector<Index> next(corner_start_.begin(), corner_start_.end() - 1);
  for (const Parallelogram& of : replaceable) {
    const auto corner = corners(of);
    for (std::size_t k = 0; k < 4; ++k) {
      corner_[next[corner[k]]++] = {copied[of.block], p.dof_start[corner[(k + 2) % 4]],
                                    {p.dof_start[corner[(k + 1) % 4]], p.dof_start[corner[(k + 3) % 4]]}};
    }
  }
  replaced_ = false;
  pattern_ = std::move(pattern);
}

void BlockRemainder::update(const BlockCsr& a) {
  parallel_for(a.rows(), rows_per_task, [&](Index begin, Index end) {
    const FlushSubnormals flush;
    update_rows(a, begin, end);
  });
}

void BlockRemainder::update_rows(const BlockCsr& a, Index begin, Index end) {
  assert(a.pattern == pattern_);
  const BlockPattern& p = *pattern_;
  for (Index i = begin; i < end; ++i) {
    const double* row = a.values.data() + p.value_start[i];
    const Index width = p.width(i);
    for (Index k = copy_start_[i]; k < copy_start_[i + 1]; ++k) copy_block_3(row + copy_[k], width, values_.data() + Offset{9} * k);
  }
}

double BlockRemainder::advance(double beta, std::span<const double> r, std::span<const double> c, std::span<double> p,
                               std::span<double> q) const {
  const Rows all = rows();
  return ordered_sum(
      pattern_->rows(), [&](Index begin, Index end) {
        const FlushSubnormals flush;
        return advance_rows(all, begin, end, beta, r.data(), c.data(), p.data(), q.data());
      },
      rows_per_task, 1);
}

void BlockRemainder::subtract(std::span<const double> c, std::span<double> q) const {
  const Rows all = rows();
  parallel_for(pattern_->rows(), rows_per_task, [&](Index begin, Index end) {
    const FlushSubnormals flush;
    for (Index i = begin; i < end; ++i) {
      double product[3];
      all.product(i, c.data(), product);
      for (Index r = 0; r < 3; ++r) q[3 * i + r] -= product[r];
    }
  });
}

BlockRemainder::Ratios BlockRemainder::ratios(std::span<const double> masses) const {
  constexpr double up = 1.0 + 1e-6;  // the blocks are rounded
  const Rows all = rows();
  const Index nodes = pattern_->rows(), tasks = (nodes + rows_per_task - 1) / rows_per_task;
  std::vector<Ratios> largest(static_cast<std::size_t>(tasks));
  parallel_for(tasks, 1, [&](Index begin, Index end) {
    const FlushSubnormals flush;
    for (Index t = begin; t < end; ++t)
      largest[t] = largest_ratios(all, rows_per_task * t, std::min(nodes, rows_per_task * (t + 1)), masses.data());
  });
  Ratios result;
  for (const Ratios& of : largest) result = {std::max(result.dropped, of.dropped), std::max(result.replaced, of.replaced)};
  return {up * std::sqrt(result.dropped), up * std::sqrt(result.replaced)};
}

Offset BlockRemainder::bytes() const {
  const auto bytes_of = [](const auto& list) { return static_cast<Offset>(list.size() * sizeof(list[0])); };
  return bytes_of(values_) + bytes_of(copy_start_) + bytes_of(copy_) + bytes_of(term_) + bytes_of(corner_) + bytes_of(row_start_) + bytes_of(row_split_) + bytes_of(corner_start_);
}

}  // namespace taut
