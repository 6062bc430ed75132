#include "taut/linalg/block_remainder.h"

#include <cassert>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"
#include "taut/linalg/small_block.h"

namespace taut {

namespace {

constexpr Index rows_per_task = 512;
constexpr Index overread = 3;  // entries behind a block's last row that a load of four takes in

using Four = double __attribute__((vector_size(32), aligned(8), may_alias));
using FourSingle = float __attribute__((vector_size(16), aligned(4), may_alias));

using Place = BlockRemainder::Place;

// E's row of a node times c: lane by lane, summed at the end.
TAUT_ALWAYS_INLINE void row_product(const Place* begin, const Place* end, const float* block, const double* c, const double* own, double* product) {
  Four sum[3] = {};
  const Four mine = {own[0], own[1], own[2], 0.0};
  for (const Place* place = begin; place < end; ++place, block += 9) {
    const double* from = c + place->column_dof;
    const Four x = Four{from[0], from[1], from[2], 0.0} - mine;
    for (Index r = 0; r < 3; ++r) sum[r] += __builtin_convertvector(*reinterpret_cast<const FourSingle*>(block + 3 * r), Four) * x;
  }
  for (Index r = 0; r < 3; ++r) product[r] = (sum[r][0] + sum[r][2]) + sum[r][1];
}

TAUT_MULTIVERSION double advance_rows(const Index* row_start, const Place* place, const float* values, Index begin, Index end, double beta,
                                      const double* r, const double* c, double* p, double* q) {
  double energy = 0.0;
  for (Index i = begin; i < end; ++i) {
    double product[3];
    row_product(place + row_start[i], place + row_start[i + 1], values + Offset{9} * row_start[i], c, c + 3 * i, product);
    for (Index j = 3 * i; j < 3 * i + 3; ++j) {
      p[j] = r[j] + beta * p[j];
      q[j] = p[j] + product[j - 3 * i];
      energy += c[j] * q[j];
    }
  }
  return energy;
}

}  // namespace

void BlockRemainder::analyze(std::shared_ptr<const BlockPattern> pattern, std::span<const std::uint8_t> mask) {
  const BlockPattern& p = *pattern;
  assert(static_cast<Index>(mask.size()) == p.blocks() && p.uniform_dim == 3);
  row_start_.assign(1, 0);
  place_.clear();
  for (Index i = 0; i < p.rows(); ++i) {
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      if (!mask[k] && k != p.diagonal[i]) place_.push_back({p.column_dof[k], p.block_offset[k]});
    row_start_.push_back(static_cast<Index>(place_.size()));
  }
  values_.assign(static_cast<std::size_t>(nonzeros()) + overread, 0.0f);
  pattern_ = std::move(pattern);
}

void BlockRemainder::update(const BlockCsr& a) {
  parallel_for(a.rows(), rows_per_task, [&](Index begin, Index end) { update_rows(a, begin, end); });
}

void BlockRemainder::update_rows(const BlockCsr& a, Index begin, Index end) {
  assert(a.pattern == pattern_);
  const BlockPattern& p = *pattern_;
  for (Index i = begin; i < end; ++i) {
    const double* row = a.values.data() + p.value_start[i];
    const Index width = p.width(i);
    for (Index k = row_start_[i]; k < row_start_[i + 1]; ++k) copy_block_3(row + place_[k].in_row, width, values_.data() + Offset{9} * k);
  }
}

double BlockRemainder::advance(double beta, std::span<const double> r, std::span<const double> c, std::span<double> p,
                               std::span<double> q) const {
  return ordered_sum(
      pattern_->rows(),
      [&](Index begin, Index end) {
        return advance_rows(row_start_.data(), place_.data(), values_.data(), begin, end, beta, r.data(), c.data(), p.data(), q.data());
      },
      rows_per_task, 1);
}

Offset BlockRemainder::bytes() const {
  return static_cast<Offset>(values_.size() * sizeof(float) + place_.size() * sizeof(Place) + row_start_.size() * sizeof(Index));
}

}  // namespace taut
