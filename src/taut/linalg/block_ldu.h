#pragma once
// A factored preconditioner with A's own pattern, M = L D U, and its solution: what IC(0), SSOR and
// ILU(0) leave behind (Saad, "Iterative Methods for Sparse Linear Systems", 2nd ed., 10.3, 11.6).
//
//   L     unit lower triangular, strictly lower blocks `lower`
//   D⁻¹   `inverse_diagonal`, one block a node
//   U     unit upper triangular, strictly upper blocks `upper`; of a symmetric M, U = Lᵀ and
//         `upper` is empty: the backward sweep scatters Lᵀ, which halves the memory
//   M z = r:   w = L⁻¹ r (rows in order),   v = D⁻¹ w,   z = U⁻¹ v (rows backwards)
//
// Both sweeps read every block once, on one thread, so their bits depend on nothing. Why not on
// more threads: docs/design/incomplete-factors.md.

#include <span>

#include "taut/linalg/triangular_layout.h"

namespace taut {

class BlockLdu {
 public:
  // Takes the pattern over and makes room for the values. Symbolic work is kept while the pattern
  // is the same object.
  void set_pattern(const std::shared_ptr<const BlockPattern>& pattern, bool symmetric);
  // z = M⁻¹ r; dofs() doubles each, not overlapping.
  void solve(std::span<const double> r, std::span<double> z) const;

  const TriangularLayout& layout() const { return layout_; }
  Index block_size() const { return layout_.block * layout_.block; }
  // The values, block after block in the layout's order, each row-major: to be
  // filled by whoever factorises.
  double* lower(Index k) { return &lower_[static_cast<std::size_t>(k) * block_size()]; }
  double* upper(Index k) { return &upper_[static_cast<std::size_t>(k) * block_size()]; }
  double* inverse_diagonal(Index place) {
    return &inverse_diagonal_[static_cast<std::size_t>(place) * block_size()];
  }
  Offset bytes() const;

 private:
  TriangularLayout layout_;
  std::vector<double> lower_, upper_, inverse_diagonal_;
  mutable std::vector<double> w_, v_;  // in level order
};

}  // namespace taut
