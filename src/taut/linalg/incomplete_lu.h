#pragma once
// Incomplete LU factorisation with zero fill-in, on node blocks: ILU(0) (Saad, "Iterative Methods
// for Sparse Linear Systems", 2nd ed., section 10.3).
//
//   A ≈ M = L D U   L, U unit triangular with the blocks of A's triangles, D: diagonal blocks;
//                   M - A is zero on A's pattern
//
// For nonsymmetric A; M is then not symmetric either: for BiCGSTAB, not for conjugate gradients.
// Exact where the factors fill nothing in. Without pivoting between nodes. The order is that of the
// nodes (linalg/triangular_layout.h).

#include "taut/linalg/block_ldu.h"
#include "taut/linalg/preconditioner.h"

namespace taut {

class BlockIncompleteLu : public Preconditioner {
 public:
  // breakdown: some D_i is singular or worse conditioned than 1e14; not_finite.
  Status update(const BlockCsr& a) override;
  void apply(std::span<const double> r, std::span<double> z) const override { factor_.solve(r, z); }
  Offset bytes() const override { return factor_.bytes(); }

 private:
  BlockLdu factor_;
};

}  // namespace taut
