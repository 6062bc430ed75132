#pragma once
// Which of A's blocks are added to which of the gathered ones when parallelograms stand in for
// blocks that are left out (linalg/parallelogram.h): of B = -A_ac
//
//   B to the diagonal blocks of all four corners and to the block of b and d, -B to the four sides
//
// so to any one block always B or always -B.

#include <span>
#include <vector>

#include "taut/linalg/block_cholesky/factor_layout.h"
#include "taut/linalg/parallelogram.h"

namespace taut {

struct Replacement {
  struct Addend {
    // of the block's first entry in A, relative to the first of the row that is gathered
    Index value;
    Index width;  // of its row there
  };
  // per row of A: its addends, block by block as they are gathered from it
  std::vector<Index> row_start;
  // per block in the order of FactorLayout::row_value: how many are its own ...
  std::vector<Index> count;
  std::vector<float> factor;  // ... and what multiplies them: 1 or -1
  std::vector<Addend> addend;

  Offset bytes() const;
};

// The layout is of a graph of that pattern's nodes, all of them with three unknowns.
Replacement plan_replacement(std::span<const Parallelogram> replaced, const BlockPattern& pattern,
                             const FactorLayout& layout);

}  // namespace taut
