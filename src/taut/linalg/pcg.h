#pragma once
// Preconditioned conjugate gradients for symmetric positive definite A: the paper's uPCG, with the
// stop test of Ascher & Boxerman (2003):
//
//   δ = rᵀ M_p⁻¹ r,  stop when  δ <= tolerance² δ0,  δ0 = bᵀ M_p⁻¹ b
//
// δ0 does not depend on the initial guess. One product and one preconditioner application an
// iteration. b = 0 returns x = 0 at once. Outcomes: converged, max_iterations,
// not_positive_definite (cᵀAc <= 0 or δ < 0), not_finite.

#include "taut/linalg/block_csr.h"
#include "taut/linalg/krylov.h"
#include "taut/linalg/preconditioner.h"

namespace taut {

// x: the initial guess in, the solution out. Allocates four vectors.
KrylovResult pcg(const LinearOperator& a, const Preconditioner& m, std::span<const double> b,
                 std::span<double> x, const KrylovOptions& options);

class BlockCsrOperator : public LinearOperator {
 public:
  explicit BlockCsrOperator(const BlockCsr& a) : a_(a) {}
  Index size() const override { return a_.dofs(); }
  double multiply_dot(std::span<const double> x, std::span<double> y) const override {
    return taut::multiply_dot(a_, x, y);
  }

 private:
  const BlockCsr& a_;
};

}  // namespace taut
