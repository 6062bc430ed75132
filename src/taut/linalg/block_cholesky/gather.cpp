// NumericFactor's first pass: A's blocks in the order of elimination. Row `node` of A read across
// is the pivots' column read down.

#include <algorithm>

#include "taut/base/flush_subnormals.h"
#include "taut/base/parallel.h"
#include "taut/base/simd.h"
#include "taut/linalg/block_cholesky/numeric_factor.h"
#include "taut/linalg/block_cholesky/quad.h"

namespace taut {

namespace {

constexpr Index rows_per_task = 512;
// between visits: they stay in the first-level cache
constexpr Index rows_at_once = 8;
constexpr Index rows_ahead = 8;  // for whose blocks the place is asked for
// ahead of which A's values are asked for
constexpr Index prefetch_distance = 4096 / sizeof(double);

// The first column of the block of two nodes in A's row of the first, or -1; for a matrix that has
// not the analysed pattern itself.
Index find_block(const BlockPattern& p, Index node, Index other) {
  const Index k = p.find(node, other);
  return k < 0 ? -1 : p.block_offset[k];
}

typedef double Doubles __attribute__((vector_size(32), aligned(8), may_alias));

// A 3x3 block of A and what is added to it: row by row, lane by lane, the fourth one nobody's.
// Reads one number behind the row.
struct BlockSum {
  Doubles row[3];

  TAUT_ALWAYS_INLINE BlockSum() : row{} {}
  TAUT_ALWAYS_INLINE BlockSum(const double* from, Index width) {
    for (Index j = 0; j < 3; ++j) row[j] = *reinterpret_cast<const Doubles*>(from + j * width);
  }
  TAUT_ALWAYS_INLINE void add(const double* from, Index width) {
    for (Index j = 0; j < 3; ++j) row[j] += *reinterpret_cast<const Doubles*>(from + j * width);
  }
  TAUT_ALWAYS_INLINE void add(double factor, const BlockSum& other) {
    const Doubles f = {factor, factor, factor, factor};
    for (Index j = 0; j < 3; ++j) row[j] += f * other.row[j];
  }
  template <class T>
  TAUT_ALWAYS_INLINE void write(T* to) const {
    for (Index j = 0; j < 2; ++j)
      quad(to + 3 * j) = __builtin_convertvector(row[j], typename Quad<T>::Type);
    put_three(__builtin_convertvector(row[2], typename Quad<T>::Type), to + 6);
  }
};

// What gathering rows of 3x3 blocks of the analysed pattern itself reads. All of it lies in the
// order of A's rows.
struct PlainRows {
  const double* values;
  const Offset *value_start, *to;
  const Index *block_start, *block_value;
  const Index *lumped_start, *lumped_end, *lumped;  // null: none is lumped
  const Index* addend_start;                        // null: nothing is replaced
  const Index* addend_count;
  const float* addend_factor;
  const Replacement::Addend* addend;
};

// Where a row's blocks will go: in the order of elimination, so anywhere.
template <class T>
TAUT_ALWAYS_INLINE void prefetch_gathered(const PlainRows& rows, Index i, const T* gathered) {
  if (rows.to[i] < 0) return;
  constexpr Offset line = 64 / sizeof(T);
  const Offset end = rows.to[i] + Offset{9} * (rows.block_start[i + 1] - rows.block_start[i]);
  for (Offset at = rows.to[i] / line * line; at < end; at += line)
    __builtin_prefetch(gathered + at, 1, 2);
}

template <class T>
TAUT_ALWAYS_INLINE void gather_plain_row(const PlainRows& rows, Index i, T* gathered) {
  const Index width = static_cast<Index>((rows.value_start[i + 1] - rows.value_start[i]) / 3);
  const double* row = rows.values + rows.value_start[i];
  for (Index l = 0; l < 3 * width; l += 8) __builtin_prefetch(row + prefetch_distance + l, 0, 2);
  T* to = gathered + rows.to[i];
  const Index begin = rows.block_start[i], end = rows.block_start[i + 1];
  const Replacement::Addend* addend =
      rows.addend_start ? rows.addend + rows.addend_start[i] : nullptr;
  for (Index e = begin; e < end; ++e, to += 9) {
    const Index value = rows.block_value[e];
    BlockSum sum = value >= 0 ? BlockSum(row + value, width) : BlockSum();
    if (e == begin && rows.lumped)
      for (Index l = rows.lumped_start[i]; l < rows.lumped_end[i]; ++l)
        sum.add(row + rows.lumped[l], width);
    if (addend && rows.addend_count[e] > 0) {
      BlockSum added;
      for (const Replacement::Addend* stop = addend + rows.addend_count[e]; addend < stop; ++addend)
        added.add(row + addend->value, addend->width);
      sum.add(rows.addend_factor[e], added);
    }
    sum.write(to);
  }
}

template <class T>
TAUT_ALWAYS_INLINE void gather_plain_rows(const PlainRows& rows, Index begin, Index end, Index last,
                                          T* gathered) {
  for (Index i = begin; i < end; ++i) {
    if (i + rows_ahead < last) prefetch_gathered(rows, i + rows_ahead, gathered);
    gather_plain_row(rows, i, gathered);
  }
}

TAUT_MULTIVERSION void gather_rows(const PlainRows& rows, Index begin, Index end, Index last,
                                   float* gathered) {
  gather_plain_rows(rows, begin, end, last, gathered);
}
TAUT_MULTIVERSION void gather_rows(const PlainRows& rows, Index begin, Index end, Index last,
                                   double* gathered) {
  gather_plain_rows(rows, begin, end, last, gathered);
}

}  // namespace

// Blocks of any size; what A has not is zero.
template <class T>
void NumericFactor<T>::gather_row(const FactorSource& source, Index k) {
  const BlockPattern& p = *source.a.pattern;
  const Index node = layout_.node[k], dim = p.dim(node), width = p.width(node);
  const double* row = source.a.values.data() + p.value_start[node];
  T* to = gathered_.data() + layout_.gathered_start[k];
  for (Index e = layout_.block_start[k]; e < layout_.block_start[k + 1]; ++e) {
    const Index other = layout_.block[e].place, other_weight = layout_.node_weight[other],
                size = layout_.node_weight[k] * other_weight;
    const Index value =
        source.pattern_is_analyzed
            ? layout_.row_value[layout_.row_start[node] + e - layout_.block_start[k]]
            : find_block(p, node, layout_.node[other]);
    std::fill(to, to + size, T(0));
    for (Index j = 0; j < dim && value >= 0; ++j)
      for (Index i = 0; i < p.dim(layout_.node[other]); ++i)
        to[j * other_weight + i] = static_cast<T>(row[j * width + value + i]);
    if (e == layout_.block_start[k] && source.lumped)
      for (const Index lumped : source.lumped->row(node, !source.replaced.empty()))
        for (Index j = 0; j < dim; ++j)
          for (Index i = 0; i < dim; ++i)
            to[j * other_weight + i] += static_cast<T>(row[j * width + lumped + i]);
    to += size;
  }
}

// What is added to the blocks of a row that gather_row has gathered.
template <class T>
void NumericFactor<T>::add_replaced(const FactorSource& source, Index row) {
  const Index k = layout_.place[row];
  T* to = gathered_.data() + layout_.gathered_start[k];
  const Replacement::Addend* addend = replacement_.addend.data() + replacement_.row_start[row];
  const double* values = source.a.values.data() + source.a.pattern->value_start[row];
  for (Index e = layout_.row_start[row]; e < layout_.row_start[row + 1]; ++e, to += 9)
    for (const auto* stop = addend + replacement_.count[e]; addend < stop; ++addend)
      for (Index entry = 0; entry < 9; ++entry)
        to[entry] += replacement_.factor[e] *
                     static_cast<T>(values[addend->value + entry / 3 * addend->width + entry % 3]);
}

template <class T>
void NumericFactor<T>::gather(const FactorSource& source) {
  const BlockPattern& p = *source.a.pattern;
  const bool is_plain = source.pattern_is_analyzed && p.uniform_dim == 3,
             is_replaced = !source.replaced.empty();
  const UnanalyzedBlocks* lumped = source.lumped;
  const PlainRows rows{
      source.a.values.data(),
      p.value_start.data(),
      layout_.row_to.data(),
      layout_.row_start.data(),
      layout_.row_value.data(),
      lumped ? lumped->row_start.data() : nullptr,
      lumped ? (is_replaced ? lumped->row_split.data() : lumped->row_start.data() + 1) : nullptr,
      lumped ? lumped->value.data() : nullptr,
      is_replaced ? replacement_.row_start.data() : nullptr,
      replacement_.count.data(),
      replacement_.factor.data(),
      replacement_.addend.data()};
  // The last row ends where A does: nothing may be read behind it.
  const Index plain_end = is_plain ? p.rows() - 1 : 0;
  parallel_for(p.rows(), rows_per_task, [&](Index begin, Index end) {
    const FlushSubnormals flush;
    for (Index i = begin; i < end; i += rows_at_once) {
      const Index stop = std::min(end, i + rows_at_once),
                  plain_stop = std::clamp(plain_end, i, stop);
      gather_rows(rows, i, plain_stop, plain_end, gathered_.data());
      for (Index row = plain_stop; row < stop; ++row) {
        if (layout_.place[row] < 0) continue;
        gather_row(source, layout_.place[row]);
        if (is_replaced) add_replaced(source, row);
      }
      if (layout_.condensed > 0) condense_rows(i, stop);
      if (source.visit) (*source.visit)(i, stop);
    }
  });
}

template void NumericFactor<float>::gather(const FactorSource&);
template void NumericFactor<double>::gather(const FactorSource&);

}  // namespace taut
