// NumericFactor's first pass: A's blocks in the order of elimination. Row `node` of A read across is the pivots' column read down.

#include <algorithm>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"
#include "taut/linalg/block_cholesky/numeric_factor.h"
#include "taut/linalg/small_block.h"

namespace taut {

namespace {

constexpr Index rows_per_task = 512;
constexpr Index rows_at_once = 8;                         // between visits: they stay in the first-level cache
constexpr Index rows_ahead = 8;                           // for whose blocks the place is asked for
constexpr Index prefetch_distance = 4096 / sizeof(double);  // ahead of which A's values are asked for

// The first column of the block of two nodes in A's row of the first, or -1; for a matrix that has not the analysed pattern itself.
Index find_block(const BlockPattern& p, Index node, Index other) {
  const Index k = p.find(node, other);
  return k < 0 ? -1 : p.block_offset[k];
}

typedef double Doubles __attribute__((vector_size(32), aligned(8), may_alias));

// The sum of 3x3 blocks of a row, the first of which begins at column `first`. Reads one number behind the row.
template <class T>
TAUT_ALWAYS_INLINE void sum_blocks_3(const double* row, Index width, Index first, std::span<const Index> others, T* to) {
  for (Index j = 0; j < 3; ++j, row += width) {
    Doubles sum = *reinterpret_cast<const Doubles*>(row + first);
    for (const Index other : others) sum += *reinterpret_cast<const Doubles*>(row + other);
    for (Index i = 0; i < 3; ++i) to[3 * j + i] = static_cast<T>(sum[i]);
  }
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
    const Index other = layout_.block[e].place, other_weight = layout_.node_weight[other], size = layout_.node_weight[k] * other_weight;
    const Index value = source.pattern_is_analyzed ? layout_.block_value[e] : find_block(p, node, layout_.node[other]);
    std::fill(to, to + size, T(0));
    for (Index j = 0; j < dim && value >= 0; ++j)
      for (Index i = 0; i < p.dim(layout_.node[other]); ++i) to[j * other_weight + i] = static_cast<T>(row[j * width + value + i]);
    if (e == layout_.block_start[k] && source.lumped)
      for (const Index lumped : source.lumped->row(node))
        for (Index j = 0; j < dim; ++j)
          for (Index i = 0; i < dim; ++i) to[j * other_weight + i] += static_cast<T>(row[j * width + lumped + i]);
    to += size;
  }
}

// Where a node's blocks will go: in the order of elimination, so anywhere.
template <class T>
TAUT_ALWAYS_INLINE void NumericFactor<T>::prefetch_gathered(Index k) const {
  if (k < 0) return;
  constexpr Offset line = 64 / sizeof(T);
  const Offset end = layout_.gathered_start[k] + Offset{9} * (layout_.block_start[k + 1] - layout_.block_start[k]);
  for (Offset at = layout_.gathered_start[k] / line * line; at < end; at += line) __builtin_prefetch(gathered_.data() + at, 1, 2);
}

template <class T>
void NumericFactor<T>::gather(const FactorSource& source) {
  const BlockPattern& p = *source.a.pattern;
  const bool is_plain = source.pattern_is_analyzed && p.uniform_dim == 3;
  const auto row_3 = [&](Index i) {
    const Index k = layout_.place[i], width = p.width(i);
    const double* row = source.a.values.data() + p.value_start[i];
    for (Index l = 0; l < 3 * width; l += 8) __builtin_prefetch(row + prefetch_distance + l, 0, 2);
    if (i + rows_ahead < p.rows()) prefetch_gathered(layout_.place[i + rows_ahead]);
    T* to = gathered_.data() + layout_.gathered_start[k];
    Index e = layout_.block_start[k];
    if (source.lumped) {
      sum_blocks_3(row, width, layout_.block_value[e++], source.lumped->row(i), to);
      to += 9;
    }
    for (; e < layout_.block_start[k + 1]; ++e, to += 9) copy_block_3(row + layout_.block_value[e], width, to);
  };
  parallel_for(p.rows(), rows_per_task, [&](Index begin, Index end) {
    for (Index i = begin; i < end; i += rows_at_once) {
      const Index stop = std::min(end, i + rows_at_once);
      for (Index row = i; row < stop; ++row) {
        // The last row ends where A does: nothing may be read behind it.
        if (is_plain && row + 1 < p.rows()) {
          row_3(row);
        } else if (layout_.place[row] >= 0) {
          gather_row(source, layout_.place[row]);
        }
      }
      if (source.visit) (*source.visit)(i, stop);
    }
  });
}

template void NumericFactor<float>::gather(const FactorSource&);
template void NumericFactor<double>::gather(const FactorSource&);

}  // namespace taut
