#pragma once
// Incomplete Cholesky factorisation with zero fill-in, on node blocks: IC(0) (Meijerink & van der
// Vorst 1977). L: unit lower triangular with the blocks of A's lower triangle, D: diagonal blocks.
//
//   A + α blockdiag(A) ≈ M = L D Lᵀ
//   W_ij = A_ij - Σ_k W_ik L_jkᵀ            k < j, where both blocks are there
//   L_ij = W_ij D_j⁻¹
//   D_i  = (1+α) A_ii - Σ_j L_ij W_ijᵀ
//
// α = 0 if that works, else about the least that does: found by doubling from `first_shift`, then
// `shift_refinements` halvings on a logarithmic scale; remark() tells α and the number of
// factorisations. Exact where the factor fills nothing in. Blocks of 0 to 3 unknowns; as scalars
// when no node has more than one. Order of the nodes: linalg/triangular_layout.h. Breakdown, shifts
// and frames: docs/design/incomplete-factors.md.

#include "taut/linalg/block_ldu.h"
#include "taut/linalg/preconditioner.h"

namespace taut {

class BlockIncompleteCholesky : public Preconditioner {
 public:
  static constexpr double first_shift = 1e-3;
  // a positive definite A needs less than the most blocks in a row
  static constexpr double largest_shift = 1e3;
  static constexpr int shift_refinements = 3;

  // A symmetric. not_positive_definite: a diagonal block of A itself is not, or no shift helps.
  Status update(const BlockCsr& a) override;
  void apply(std::span<const double> r, std::span<double> z) const override { factor_.solve(r, z); }
  Offset bytes() const override { return factor_.bytes(); }
  std::string remark() const override;
  int preparations() const override { return factorizations_; }

  double shift() const { return shift_; }
  int factorizations() const { return factorizations_; }

 private:
  // The node where it breaks down, or -1.
  Index factorize(const BlockCsr& a, double shift);
  Status find_shift(const BlockCsr& a, Index broken_node);

  BlockLdu factor_;
  double shift_ = 0.0;
  int factorizations_ = 0;
  Index broken_node_ = -1;  // of the first try
};

}  // namespace taut
