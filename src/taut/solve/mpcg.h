#pragma once
// Modified preconditioned conjugate gradients on the full system (A, S, z): the paper's MPCG
// (Section 2, Ascher & Boxerman 2003).
//
//   x0 = S guess + (I-S) z        b̂ = S(b - A(I-S)z)       δ0 = b̂ᵀ M_p⁻¹ b̂
//   r = S(b - A x)    c = S M_p⁻¹ r    δ = rᵀ c
//   while δ > tol² δ0:   q = S A c    α = δ/(cᵀq)    x += α c    r -= α q    s = M_p⁻¹ r    δ' = rᵀ
//   s    c = S(s + δ'/δ c)
//
// S is the identity but at the constrained nodes: it is applied there only, right behind the matrix
// product. Preconditioners that couple nodes are made from S A S + d (I-S), see
// solve/preconditioner_choice.h.

#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/solver.h"

namespace taut {

class Mpcg : public ConstrainedSolver {
 public:
  Mpcg(SolverOptions options, const PreconditionerChoice& choice)
      : ConstrainedSolver(std::move(options)), choice_(choice) {}

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  PreconditionerChoice choice_;
  PreconditionerMatrix source_;
  std::unique_ptr<Preconditioner> m_;
  std::vector<double> r_, s_, c_, q_;
};

}  // namespace taut
