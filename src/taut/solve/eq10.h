#pragma once
// The paper's Eq. 10, (S A + d (I-S)) x = S b + d (I-S) z, solved by BiCGSTAB since it is not
// symmetric. The paper holds it not to be equivalent to Eq. 5 and 6; multiplied by S and by I - S
// it gives back both (docs/mathematics.md, 3.3), and a test shows the same solution. The tolerance
// is that of the residual norm, relative to the right-hand side.
//
// Preconditioned by the diagonal blocks of the symmetric form S A S + d (I-S), or by ILU(0) of Eq.
// 10's own matrix.

#include "taut/linalg/preconditioner.h"
#include "taut/solve/solver.h"

namespace taut {

enum class Eq10Preconditioner { block_diagonal, ilu0 };

class Eq10 : public ConstrainedSolver {
 public:
  Eq10(SolverOptions options, Eq10Preconditioner kind)
      : ConstrainedSolver(std::move(options)), kind_(kind) {}

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  Eq10Preconditioner kind_;
  BlockCsr filtered_;
  std::unique_ptr<Preconditioner> m_;
};

}  // namespace taut
