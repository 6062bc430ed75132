#include "taut/linalg/triangular_layout.h"

#include <algorithm>

namespace taut {

namespace {

std::vector<Index> levels_of(const BlockPattern& p) {
  std::vector<Index> level(static_cast<std::size_t>(p.rows()), 0);
  for (Index i = 0; i < p.rows(); ++i) {
    if (p.dim(i) == 0) continue;
    const Index begin = p.row_start[i], end = p.row_start[i + 1];
    for (Index k = begin; k < end && p.column[k] < i; ++k)
      if (p.dim(p.column[k]) > 0) level[i] = std::max(level[i], level[p.column[k]] + 1);
    // Blocks without a counterpart below the diagonal.
    for (Index k = p.diagonal[i] + 1; k < end; ++k)
      level[p.column[k]] = std::max(level[p.column[k]], level[i] + 1);
  }
  return level;
}

TriangularRows rows_of(const BlockPattern& p, const std::vector<Index>& node,
                       const std::vector<Index>& place, bool below) {
  TriangularRows rows;
  rows.start.push_back(0);
  std::vector<std::pair<Index, Index>> row;
  for (const Index i : node) {
    row.clear();
    const Index begin = below ? p.row_start[i] : p.diagonal[i] + 1,
                end = below ? p.diagonal[i] : p.row_start[i + 1];
    for (Index k = begin; k < end; ++k)
      if (p.dim(p.column[k]) > 0) row.emplace_back(place[p.column[k]], k);
    std::ranges::sort(row);
    for (const auto& [column, k] : row) rows.column.push_back(column), rows.source.push_back(k);
    rows.start.push_back(static_cast<Index>(rows.column.size()));
  }
  return rows;
}

}  // namespace

TriangularLayout triangular_layout(std::shared_ptr<const BlockPattern> pattern, bool with_upper) {
  const BlockPattern& p = *pattern;
  const std::vector<Index> level = levels_of(p);
  TriangularLayout layout;
  layout.block = 1;
  for (Index i = 0; i < p.rows(); ++i) {
    layout.levels = std::max(layout.levels, level[i] + 1);
    if (p.dim(i) > 1) layout.block = 3;
  }
  // Stable counting sort by level.
  std::vector<Index> next(static_cast<std::size_t>(layout.levels) + 1, 0),
      place(static_cast<std::size_t>(p.rows()), -1);
  for (Index i = 0; i < p.rows(); ++i)
    if (p.dim(i) > 0) ++next[level[i] + 1];
  for (Index l = 0; l < layout.levels; ++l) next[l + 1] += next[l];
  layout.node.resize(static_cast<std::size_t>(next[layout.levels]));
  for (Index i = 0; i < p.rows(); ++i)
    if (p.dim(i) > 0) layout.node[place[i] = next[level[i]]++] = i;
  for (const Index i : layout.node)
    layout.dof.push_back(p.dof_start[i]), layout.dim.push_back(p.dim(i));
  layout.lower = rows_of(p, layout.node, place, true);
  if (with_upper) layout.upper = rows_of(p, layout.node, place, false);
  layout.pattern = std::move(pattern);
  return layout;
}

Offset TriangularLayout::bytes() const {
  const auto count = node.size() * 3 + lower.start.size() + 2 * lower.column.size() +
                     upper.start.size() + 2 * upper.column.size();
  return static_cast<Offset>(count * sizeof(Index));
}

void load_padded(const BlockCsr& a, Index i, Index k, Index block, double* out) {
  const BlockPattern& p = *a.pattern;
  const Index rows = p.dim(i), columns = p.dim(p.column[k]), stride = p.width(i);
  const double* from = a.block(i, k);
  if (rows == block && columns == block) {
    for (Index r = 0; r < block; ++r)
      std::copy(from + r * stride, from + r * stride + block, out + r * block);
    return;
  }
  std::fill(out, out + block * block, 0.0);
  for (Index r = 0; r < rows; ++r)
    std::copy(from + r * stride, from + r * stride + columns, out + r * block);
  if (p.column[k] == i)
    for (Index r = rows; r < block; ++r) out[r * block + r] = 1.0;
}

}  // namespace taut
