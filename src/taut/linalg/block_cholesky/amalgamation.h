#pragma once
// Which columns are eliminated together: see supernodes.h. Knows sizes only, no rows.

#include <span>
#include <vector>

#include "taut/base/types.h"

namespace taut {

struct ColumnGroups {
  std::vector<Index> order;   // columns, group after group, parents after children
  std::vector<Index> first;   // groups + 1, into order
  std::vector<Index> parent;  // of the groups; greater than the group, or -1
};

// Columns are numbered in a postorder of their tree `parent`; count[j] = unknowns of column j of L
// with its diagonal block, weight[j] those of the diagonal block.
ColumnGroups group_columns(std::span<const Index> parent, std::span<const Index> count,
                           std::span<const Index> weight);

}  // namespace taut
