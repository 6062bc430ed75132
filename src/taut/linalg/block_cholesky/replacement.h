#pragma once
// Which of A's blocks are added to which of the gathered ones when parallelograms stand in for blocks that are left out
// (linalg/parallelogram.h). Where A_ac = -B is in the diagonal blocks of a and c already (lumped),
//
//   -2 A_ac to the diagonal blocks of a and c, -A_ac to those of b and d and to the block of b and d, A_ac to the four sides

#include <span>
#include <vector>

#include "taut/linalg/block_cholesky/factor_layout.h"
#include "taut/linalg/parallelogram.h"

namespace taut {

struct Replacement {
  struct Addend {
    Offset value;  // of the block's first entry in A
    Index width;   // of its row there
    float factor;  // multiplies
  };
  std::vector<Index> row_start;     // per row of A: its addends, block by block as they are gathered from it
  std::vector<Index> count;         // per block of the layout: how many are its own
  std::vector<Addend> addend;

  Offset bytes() const;
};

// The layout is of a graph of that pattern's nodes, all of them with three unknowns.
Replacement plan_replacement(std::span<const Parallelogram> replaced, const BlockPattern& pattern, const FactorLayout& layout);

}  // namespace taut
