#pragma once
// uPCG: the unmodified conjugate gradient method on the reduced system Ã ỹ = b̃ (paper Section 3), with a node-wise preconditioner.

#include "taut/solve/node_preconditioner.h"
#include "taut/solve/reduced_system.h"
#include "taut/solve/solver.h"

namespace taut {

enum class UpcgDiagonal {
  scalar,          // Uᵀ diag(A)⁻¹ U: MPCG's steps
  block,           // Uᵀ blockdiag(A)⁻¹ U: likewise
  reduced_scalar,  // diag(Ã): depends on the choice of U
  reduced_block    // diagonal blocks of Ã: does not
};

class Upcg : public ConstrainedSolver {
 public:
  Upcg(SolverOptions options, UpcgDiagonal kind) : ConstrainedSolver(std::move(options)), kind_(kind) {}

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  UpcgDiagonal kind_;
  ReducedSystem reduced_;
};

}  // namespace taut
