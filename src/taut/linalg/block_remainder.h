#pragma once
// What a preconditioner made of some of a matrix's blocks leaves out:
//
//   A = P + E       P: the blocks of a mask and the diagonal ones;  E: the others, copied together
//
// and with it conjugate gradients' product without reading A. For the direction c = z + β c', z = P⁻¹ r, of a method preconditioned by P
// itself, P c is known (Eisenstat 1981, SIAM J. Sci. Stat. Comput. 2, had the same idea for SSOR):
//
//   p = P c = r + β p'        q = A c = p + E c        cᵀq
//
// p is as exact as P⁻¹ was applied: in single precision that leaves a rounding error which only a residual from A itself removes.
//
// Where P has the others lumped into its diagonal (BlocksOutside in linalg/block_cholesky.h), E has on its diagonal what makes its rows sum
// to zero: E c = Σ_j E_ij (c_j - c_i).
//
// Vectors have A's unknowns. With constraints (linalg/node_basis.h), p and q hold something in constrained directions that nobody reads.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "taut/linalg/block_csr.h"

namespace taut {

class BlockRemainder {
 public:
  // mask: one byte per block, 0 for those of E. Allocates; the rest does not.
  void analyze(std::shared_ptr<const BlockPattern> pattern, std::span<const std::uint8_t> mask);
  // Takes the values of E from a matrix of that pattern (asserted).
  void update(const BlockCsr& a);
  // The same for its rows begin ... end-1; rows may be taken in any order and in parallel.
  void update_rows(const BlockCsr& a, Index begin, Index end);
  // p = r + beta p, q = p + E c; returns cᵀ q. Same bits for any number of threads.
  double advance(bool lumped, double beta, std::span<const double> r, std::span<const double> c, std::span<double> p,
                 std::span<double> q) const;
  Offset nonzeros() const { return value_start_.back(); }
  Offset bytes() const;

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  // Per block of E, row by row: its place in A's values, first unknown and number of unknowns of its column, place in values_.
  std::vector<Index> row_start_, column_dof_, column_dim_;
  std::vector<Offset> source_, value_start_{0};
  LargeVector<double> values_;  // row-major blocks, and a few entries that are read too many
};

}  // namespace taut
