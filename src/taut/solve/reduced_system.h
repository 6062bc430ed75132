#pragma once
// What uPCG, the direct solvers and corePCG share: Ã, b̃ and the reduced initial guess (paper
// Section 3).

#include "taut/constraint/reduction.h"
#include "taut/solve/linear_system.h"

namespace taut {

class ReducedSystem {
 public:
  // Forms Ã, b̃ = Uᵀ(b - A(I-S)z) and ỹ0 = Uᵀ guess. True if the pattern of Ã changed.
  bool update(const LinearSystem& system);
  // b̃ and ỹ0 only: Ã stays.
  void update_load(const LinearSystem& system);
  const BlockCsr& matrix() const { return reduction_.matrix(); }
  std::span<const double> rhs() const { return rhs_; }
  std::span<double> solution() { return solution_; }
  // x = U ỹ + (I-S) z
  void prolong_to(const LinearSystem& system, std::span<double> x) const;

 private:
  Reduction reduction_;
  std::vector<double> rhs_, solution_, scratch_;
};

}  // namespace taut
