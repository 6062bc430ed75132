#pragma once
// Symmetric successive over-relaxation on node blocks (Young 1971; Saad, "Iterative Methods for
// Sparse Linear Systems", 2nd ed., section 10.2):
//
//   M = ω/(2-ω) (D/ω + L) D⁻¹ (D/ω + Lᵀ)      0 < ω < 2 (asserted)
//
// with A = L + D + Lᵀ, D the diagonal blocks, L the strictly lower ones. ω = 1 is symmetric block
// Gauss-Seidel. M needs no factorisation and cannot break down as long as the blocks of D are
// positive definite. The order is that of the nodes (linalg/triangular_layout.h).

#include "taut/linalg/block_ldu.h"
#include "taut/linalg/preconditioner.h"

namespace taut {

class BlockSsor : public Preconditioner {
 public:
  explicit BlockSsor(double omega = 1.0);
  Status update(const BlockCsr& a) override;
  void apply(std::span<const double> r, std::span<double> z) const override { factor_.solve(r, z); }
  Offset bytes() const override { return factor_.bytes(); }

 private:
  double omega_;
  BlockLdu factor_;
};

}  // namespace taut
