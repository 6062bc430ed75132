#pragma once
// The paper's Eq. 10, (S A + d (I-S)) x = S b + d (I-S) z, solved by BiCGSTAB since it is not symmetric. The paper holds it not to be equivalent to
// Eq. 5 and 6; multiplied by S and by I - S it gives back both (MATH.md 3.3), and a test shows the same solution.
// The tolerance is that of the residual norm, relative to the right-hand side.

#include "taut/solve/solver.h"

namespace taut {

class Eq10 : public ConstrainedSolver {
 public:
  explicit Eq10(SolverOptions options) : ConstrainedSolver(std::move(options)) {}

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;
};

}  // namespace taut
