#pragma once
// uPCG: the unmodified conjugate gradient method on the reduced system Ã ỹ = b̃ (paper Section 3),
// with any preconditioner.

#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/reduced_system.h"
#include "taut/solve/solver.h"

namespace taut {

class Upcg : public ConstrainedSolver {
 public:
  Upcg(SolverOptions options, const PreconditionerChoice& choice)
      : ConstrainedSolver(std::move(options)), choice_(choice) {}

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  PreconditionerChoice choice_;
  ReducedSystem reduced_;
  PreconditionerMatrix source_;
  std::unique_ptr<Preconditioner> m_;
};

}  // namespace taut
