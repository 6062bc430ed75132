#pragma once
// Pre-filtered PCG (Tamstorf et al. 2015; docs/mathematics.md, 3.4): the symmetric cousin of Eq.
// 10, whose size and pattern never change while constraints come and go,
//
//   (S A S + d (I-S)) y = S (b - A (I-S) z)          x = y + (I-S) z          d: a mass per node,
//   see node_scale.h
//
// formed explicitly and solved by plain PCG. Block-wise preconditioners of it commute with S
// (solve/preconditioner_choice.h), so that the iterates never leave the free directions; their
// symbolic work is kept over a whole simulation.

#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/solver.h"

namespace taut {

class Ppcg : public ConstrainedSolver {
 public:
  Ppcg(SolverOptions options, const PreconditionerChoice& choice)
      : ConstrainedSolver(std::move(options)), choice_(choice) {}

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  PreconditionerChoice choice_;
  BlockCsr filtered_;
  PreconditionerMatrix source_;
  std::unique_ptr<Preconditioner> m_;
};

}  // namespace taut
