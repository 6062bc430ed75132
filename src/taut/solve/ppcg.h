#pragma once
// Pre-filtered PCG (Tamstorf et al. 2015; MATH.md 3.4): the symmetric cousin of Eq. 10, whose size and pattern never change while constraints come and go,
//
//   (S A S + d (I-S)) y = S (b - A (I-S) z)          x = y + (I-S) z          d: a mass per node, see node_scale.h
//
// formed explicitly and solved by plain PCG with its own 3x3 diagonal blocks (which commute with S).

#include "taut/solve/solver.h"

namespace taut {

class Ppcg : public ConstrainedSolver {
 public:
  explicit Ppcg(SolverOptions options) : ConstrainedSolver(std::move(options)) {}

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  BlockCsr filtered_;
};

// S A S + d (I-S) into `filtered` (same pattern as A).
void filter_matrix(const BlockCsr& a, const ConstraintSet* constraints, BlockCsr& filtered);

}  // namespace taut
