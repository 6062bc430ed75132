#pragma once
// corePCG (paper Section 6): conjugate gradients on Ã ỹ = b̃, preconditioned by a direct
// factorisation of the matrix core
//
//   P = A_core = the diagonal blocks of A and those off-diagonal blocks that a stretch spring
//   fills; where larger elements than springs are outside, their diagonal blocks only stay
//   Π P̃ Πᵀ = L Lᵀ
//
// as the paper's pseudocode goes: analyse, reorder, factorise, loop with triangular solves. Both of
// its ways to reorder are here: `matrix`: Ã, b̃ and ỹ0 are reordered once by Π and the loop runs in
// the factor's order (lines 6, 7, 22); `vectors`: the loop runs in node order, each preconditioner
// solve permutes its vectors. cond(P⁻¹A) <= 1 + q ρ, independent of the stretch stiffness
// (docs/mathematics.md, 5), and the reduction keeps that.

#include "taut/linalg/sparse_cholesky.h"
#include "taut/solve/reduced_system.h"
#include "taut/solve/solver.h"

namespace taut {

class CorePcg : public ConstrainedSolver {
 public:
  // backend: "" means cholmod if it is built in, else eigen with a remark.
  CorePcg(SolverOptions options, const std::string& backend);

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  void loop_in_factor_order(const LinearSystem& system, std::span<double> x, SolveSummary& summary);

  std::unique_ptr<SparseCholesky> cholesky_;
  ReducedSystem reduced_;
  Reduction core_;
  BlockCsr own_core_;  // where the core is not made of A's blocks
  std::string remark_;
  bool analyzed_ = false;
};

}  // namespace taut
