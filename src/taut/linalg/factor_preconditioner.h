#pragma once
// M_p⁻¹ r by a sparse Cholesky factor, which the caller owns and has factorised: in the
// unknowns' own order, or, `permuted`, for vectors in the factor's order. Allocates
// nothing; update() does nothing.

#include "taut/linalg/preconditioner.h"
#include "taut/linalg/sparse_cholesky.h"

namespace taut {

class FactorPreconditioner : public Preconditioner {
 public:
  FactorPreconditioner(SparseCholesky& factor, bool permuted)
      : factor_(factor), permuted_(permuted) {}
  Status update(const BlockCsr&) override { return {}; }
  void apply(std::span<const double> r, std::span<double> z) const override {
    permuted_ ? factor_.solve_permuted(r, z) : factor_.solve(r, z);
  }

 private:
  SparseCholesky& factor_;
  bool permuted_;
};

}  // namespace taut
