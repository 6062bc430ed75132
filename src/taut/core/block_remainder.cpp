#include "taut/core/block_remainder.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <iterator>

#include "taut/base/flush_subnormals.h"
#include "taut/base/parallel.h"
#include "taut/base/simd.h"
#include "taut/linalg/small_block.h"

namespace taut {

namespace {

constexpr Index rows_per_task = 512;  // when blocks are copied
// Of a batch: their sums stay in the cache, and what acts on rows of two batches is little. Small
// matrices are cut for some threads.
constexpr Index least_rows = 256, most_rows = 2048, batches_wanted = 16;
constexpr Index overread = 7;  // entries behind a block that a load of sixteen takes in

using Four = double __attribute__((vector_size(32)));
using FourAnywhere = double __attribute__((vector_size(32), aligned(8), may_alias));
using FourSingle = float __attribute__((vector_size(16), aligned(4), may_alias));
using SixteenSingle = float __attribute__((vector_size(64)));
using SixteenAnywhere = float __attribute__((vector_size(64), aligned(4), may_alias));
using EightSingle = float __attribute__((vector_size(32)));
using SixteenMask = std::int32_t __attribute__((vector_size(64)));

Index batch_rows(Index rows) {
  return std::clamp((rows + batches_wanted - 1) / batches_wanted, least_rows, most_rows);
}

}  // namespace

struct BlockRemainder::Pieces {
  Range springs[2], cells;  // the second springs: none where they are replaced
  const Spring* spring;
  const Cell* cell;
  const float* values;
  Index first_row, rows;
  bool has_last_node;

  // Calls f(block, places, nodes) for each spring, or cell, of a range, with where its nodes are in
  // a batch's sums. Behind those of the last row is a place for all nodes of other batches.
  template <class Piece, class Function>
  TAUT_ALWAYS_INLINE void visit(const Piece* list, const Range& range, Function f) const {
    constexpr Index count = static_cast<Index>(std::size(Piece{}.node));
    Index place[count];
    for (const Piece* s = list + range.begin; s < list + range.split; ++s) {
      for (Index k = 0; k < count; ++k) place[k] = s->node[k] - first_row;
      f(values + Offset{9} * s->block, place, s->node);
    }
    for (const Piece* s = list + range.split; s < list + range.end; ++s) {
      for (Index k = 0; k < count; ++k)
        place[k] = static_cast<Index>(
            std::min(static_cast<std::uint32_t>(s->node[k]) - static_cast<std::uint32_t>(first_row),
                     static_cast<std::uint32_t>(rows)));
      f(values + Offset{9} * s->block, place, s->node);
    }
  }
};

namespace {

using Pieces = BlockRemainder::Pieces;
using Sums = Four[most_rows + 1];

// Adds a node's three numbers, and one that is nobody's.
template <bool Exact>
TAUT_ALWAYS_INLINE void add_three(const double* c, Index node, Four& to) {
  const double* x = c + Offset{3} * node;
  if constexpr (Exact) {
    to += Four{x[0], x[1], x[2], 0.0};
  } else {
    to += *reinterpret_cast<const FourAnywhere*>(x);
  }
}

// x := B x, B symmetric.
TAUT_ALWAYS_INLINE void multiply(const float* block, Four& x) {
  Four product = {};
  for (Index r = 0; r < 3; ++r)
    product +=
        __builtin_convertvector(*reinterpret_cast<const FourSingle*>(block + 3 * r), Four) * x[r];
  x = product;
}

template <bool Exact>
TAUT_ALWAYS_INLINE void add_products(const Pieces& of, const double* c, Sums& sum) {
  for (const auto& springs : of.springs)
    of.visit(of.spring, springs,
             [&](const float* block, const Index* place, const Index* node)
                 __attribute__((always_inline)) {
                   Four force = {}, from = {};
                   add_three<Exact>(c, node[1], force);
                   add_three<Exact>(c, node[0], from);
                   force -= from;
                   multiply(block, force);
                   sum[place[0]] += force;
                   sum[place[1]] -= force;
                 });
  of.visit(of.cell, of.cells,
           [&](const float* block, const Index* place, const Index* node)
               __attribute__((always_inline)) {
                 Four force = {}, sides = {};
                 add_three<Exact>(c, node[0], force);
                 add_three<Exact>(c, node[2], force);
                 add_three<Exact>(c, node[1], sides);
                 add_three<Exact>(c, node[3], sides);
                 force -= sides;
                 multiply(block, force);
                 sum[place[0]] += force;
                 sum[place[1]] -= force;
                 sum[place[2]] += force;
                 sum[place[3]] -= force;
               });
}

TAUT_ALWAYS_INLINE void add_products(const Pieces& of, const double* c, Sums& sum) {
  of.has_last_node ? add_products<true>(of, c, sum) : add_products<false>(of, c, sum);
}

TAUT_MULTIVERSION double advance_batch(const Pieces& of, double beta, const double* r,
                                       const double* c, double* p, double* q) {
  Sums sum;
  for (Index i = 0; i < of.rows; ++i) {
    const Offset j = Offset{3} * (of.first_row + i);
    if (beta == 0.0) {
      for (Index k = 0; k < 3; ++k) p[j + k] = r[j + k];
    } else {
      for (Index k = 0; k < 3; ++k) p[j + k] = r[j + k] + beta * p[j + k];
    }
    sum[i] = Four{p[j], p[j + 1], p[j + 2], 0.0};
  }
  sum[of.rows] = Four{};
  add_products(of, c, sum);
  double energy = 0.0;
  for (Index i = 0; i < of.rows; ++i) {
    const Offset j = Offset{3} * (of.first_row + i);
    for (Index k = 0; k < 3; ++k) q[j + k] = sum[i][k];
    energy += (c[j] * sum[i][0] + c[j + 2] * sum[i][2]) + c[j + 1] * sum[i][1];
  }
  return energy;
}

TAUT_MULTIVERSION void subtract_batch(const Pieces& of, const double* c, double* q) {
  Sums sum;
  std::fill(sum, sum + of.rows + 1, Four{});
  add_products(of, c, sum);
  for (Index i = 0; i < of.rows; ++i)
    for (Index k = 0; k < 3; ++k) q[Offset{3} * (of.first_row + i) + k] -= sum[i][k];
}

// Of the first nine.
TAUT_ALWAYS_INLINE float squared_norm(const SixteenSingle& block) {
  constexpr SixteenMask nine = {-1, -1, -1, -1, -1, -1, -1, -1, -1};
  const SixteenSingle all = (SixteenSingle)((SixteenMask)(block * block) & nine);
  const EightSingle eight = __builtin_shufflevector(all, all, 0, 1, 2, 3, 4, 5, 6, 7) +
                            __builtin_shufflevector(all, all, 8, 9, 10, 11, 12, 13, 14, 15);
  const FourSingle four = __builtin_shufflevector(eight, eight, 0, 1, 2, 3) +
                          __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
  return (four[0] + four[2]) + (four[1] + four[3]);
}

// Of the sums of blocks at the batch's rows, relative to the rows' masses.
TAUT_ALWAYS_INLINE float largest_square(const Pieces& of, const double* masses,
                                        const SixteenSingle* sum) {
  float largest = 0.0f;
  for (Index i = 0; i < of.rows; ++i) {
    const float square = squared_norm(sum[i] * static_cast<float>(1.0 / masses[of.first_row + i]));
    largest = square > largest ? square : largest;
  }
  return largest;
}

// Of the rows, squared.
TAUT_MULTIVERSION BlockRemainder::Ratios largest_ratios(const Pieces& of, const double* masses) {
  BlockRemainder::Ratios largest;
  SixteenSingle sum[most_rows + 1];
  const auto add = [&](const float* block, const Index* place, auto count)
                       __attribute__((always_inline)) {
                         for (Index k = 0; k < count; ++k)
                           sum[place[k]] += *reinterpret_cast<const SixteenAnywhere*>(block);
                       };
  std::fill(sum, sum + of.rows + 1, SixteenSingle{});
  for (const auto& springs : of.springs)
    of.visit(of.spring, springs,
             [&](const float* block, const Index* place, const Index*) __attribute__((
                 always_inline)) { add(block, place, std::integral_constant<Index, 2>{}); });
  largest.dropped = largest_square(of, masses, sum);
  if (of.cells.begin == of.cells.end) return largest;
  std::fill(sum, sum + of.rows + 1, SixteenSingle{});
  of.visit(of.cell, of.cells,
           [&](const float* block, const Index* place, const Index*) __attribute__((
               always_inline)) { add(block, place, std::integral_constant<Index, 4>{}); });
  largest.replaced = largest_square(of, masses, sum);
  return largest;
}

// For each batch of rows what acts on one of them, in the order of the list.
template <class Piece>
std::vector<std::vector<Piece>> in_batches(const std::vector<Piece>& list, Index rows_per_batch,
                                           std::size_t batches) {
  std::vector<std::vector<Piece>> result(batches);
  for (const Piece& piece : list) {
    std::array<Index, std::size(Piece{}.node)> of;
    std::ranges::transform(piece.node, of.begin(),
                           [&](Index node) { return node / rows_per_batch; });
    std::ranges::sort(of);
    for (std::size_t k = 0; k < of.size(); ++k)
      if (k == 0 || of[k] != of[k - 1]) result[of[k]].push_back(piece);
  }
  return result;
}

}  // namespace

BlockRemainder::Pieces BlockRemainder::pieces(const Batch& b) const {
  constexpr Range none{0, 0, 0};
  return {{b.dropped, replaced_ ? none : b.replaceable},
          replaced_ ? b.cells : none,
          spring_.data(),
          cell_.data(),
          values_.data(),
          b.first_row,
          b.end_row - b.first_row,
          b.has_last_node};
}

void BlockRemainder::analyze(std::shared_ptr<const BlockPattern> pattern,
                             std::span<const std::uint8_t> mask,
                             std::span<const Parallelogram> replaceable) {
  const BlockPattern& p = *pattern;
  assert(static_cast<Index>(mask.size()) == p.blocks() && p.uniform_dim == 3);
  std::vector<std::uint8_t> is_replaceable(mask.size(), 0);
  for (const Parallelogram& of : replaceable) is_replaceable[of.block] = 1;
  std::vector<Index> copied(mask.size(), -1);
  copy_start_.assign(1, 0);
  copy_.clear();
  std::vector<Spring> dropped, replaced;
  std::vector<Cell> cells;
  for (Index i = 0; i < p.rows(); ++i) {
    for (Index k = p.diagonal[i] + 1; k < p.row_start[i + 1]; ++k) {
      if (mask[k]) continue;
      copied[k] = static_cast<Index>(copy_.size());
      copy_.push_back(p.block_offset[k]);
      (is_replaceable[k] ? replaced : dropped).push_back({copied[k], {i, p.column[k]}});
    }
    copy_start_.push_back(static_cast<Index>(copy_.size()));
  }
  for (const Parallelogram& of : replaceable)
    cells.push_back({copied[of.block], {of.a, of.b, of.c, of.d}});
  values_.assign(9 * copy_.size() + overread, 0.0f);

  const Index rows = batch_rows(p.rows());
  const std::size_t batches = static_cast<std::size_t>((p.rows() + rows - 1) / rows);
  const auto dropped_in = in_batches(dropped, rows, batches),
             replaced_in = in_batches(replaced, rows, batches);
  const auto cells_in = in_batches(cells, rows, batches);
  batch_.clear(), spring_.clear(), cell_.clear();
  for (std::size_t b = 0; b < batches; ++b) {
    Batch batch;
    batch.first_row = rows * static_cast<Index>(b);
    batch.end_row = std::min(p.rows(), batch.first_row + rows);
    batch.has_last_node = false;
    const auto add = [&](const auto& from, auto& to) {
      const auto is_within = [&](const auto& piece) {
        return std::ranges::all_of(piece.node, [&](Index node) {
          return node >= batch.first_row && node < batch.end_row;
        });
      };
      Range range{static_cast<Index>(to.size()), 0, 0};
      std::ranges::copy_if(from, std::back_inserter(to), is_within);
      range.split = static_cast<Index>(to.size());
      std::ranges::copy_if(from, std::back_inserter(to), std::not_fn(is_within));
      range.end = static_cast<Index>(to.size());
      batch.has_last_node |= std::ranges::any_of(from, [&](const auto& piece) {
        return std::ranges::count(piece.node, p.rows() - 1) > 0;
      });
      return range;
    };
    batch.dropped = add(dropped_in[b], spring_);
    batch.replaceable = add(replaced_in[b], spring_);
    batch.cells = add(cells_in[b], cell_);
    batch_.push_back(batch);
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
    for (Index k = copy_start_[i]; k < copy_start_[i + 1]; ++k)
      copy_block_3(row + copy_[k], width, values_.data() + Offset{9} * k);
  }
}

double BlockRemainder::advance(double beta, std::span<const double> r, std::span<const double> c,
                               std::span<double> p, std::span<double> q) const {
  return ordered_sum(
      static_cast<Index>(batch_.size()),
      [&](Index b, Index) {
        const FlushSubnormals flush;
        return advance_batch(pieces(batch_[b]), beta, r.data(), c.data(), p.data(), q.data());
      },
      1, 1);
}

void BlockRemainder::subtract(std::span<const double> c, std::span<double> q) const {
  parallel_for(static_cast<Index>(batch_.size()), 1, [&](Index begin, Index end) {
    const FlushSubnormals flush;
    for (Index b = begin; b < end; ++b) subtract_batch(pieces(batch_[b]), c.data(), q.data());
  });
}

BlockRemainder::Ratios BlockRemainder::ratios_in(Index batch,
                                                 std::span<const double> masses) const {
  constexpr double up = 1.0 + 2e-6;  // the blocks and their sums are rounded
  const FlushSubnormals flush;
  const Ratios squares = largest_ratios(pieces(batch_[batch]), masses.data());
  return {up * std::sqrt(squares.dropped), up * std::sqrt(squares.replaced)};
}

BlockRemainder::Ratios BlockRemainder::largest(std::span<const Ratios> of_batches) {
  Ratios result;
  for (const Ratios& of : of_batches)
    result = {std::max(result.dropped, of.dropped), std::max(result.replaced, of.replaced)};
  return result;
}

BlockRemainder::Ratios BlockRemainder::ratios(std::span<const double> masses) const {
  std::vector<Ratios> of_batches(batch_.size());
  parallel_for(batches(), 1, [&](Index begin, Index end) {
    for (Index b = begin; b < end; ++b) of_batches[b] = ratios_in(b, masses);
  });
  return largest(of_batches);
}

Offset BlockRemainder::bytes() const {
  const auto bytes_of = [](const auto& list) {
    return static_cast<Offset>(list.size() * sizeof(list[0]));
  };
  return bytes_of(values_) + bytes_of(copy_start_) + bytes_of(copy_) + bytes_of(batch_) +
         bytes_of(spring_) + bytes_of(cell_);
}

}  // namespace taut
