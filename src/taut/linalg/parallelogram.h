#pragma once
// What can stand in for a spring between two nodes a, c whose block a preconditioner has no place
// for (docs/mathematics.md, 5). By the law of parallelograms, for any four points and any symmetric
// B, with B(u) = uᵀ B u,
//
//   B(a-b) + B(b-c) + B(c-d) + B(d-a) - B(b-d)  =  B(a-c) + B(a-b+c-d)
//
// so a spring B on each side a b, b c, c d, d a and -B on the diagonal b d act as B between a and c
// and one term more, which is not negative and nothing at all where the motion is affine over a
// parallelogram: in each cell of a grid, the cell's other diagonal.

#include <cstdint>
#include <span>
#include <vector>

#include "taut/linalg/block_csr.h"

namespace taut {

// Four nodes in turn, a < c. block: the one of A at (a, c); opposite: at (c, a).
struct Parallelogram {
  Index a, b, c, d;
  Index block, opposite;
};

// One for each pair a, c whose block is not among `kept` and that has exactly two common
// neighbours b, d in `sides`, whose own block is kept but no side: the other diagonal of a
// cell. (Two triangles with a common side b d are often no parallelogram, and springs across
// it were found to lose by this.) One byte per block of the pattern each, sides among kept.
// In the order of a, then c.
std::vector<Parallelogram> parallelograms(const BlockPattern& pattern,
                                          std::span<const std::uint8_t> sides,
                                          std::span<const std::uint8_t> kept);

}  // namespace taut
