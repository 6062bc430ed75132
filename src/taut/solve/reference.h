#pragma once
// A solution to measure others against (docs/mathematics.md, 4), and the distance to it:
//
//   Ã ỹ* = b̃   by sparse Cholesky with iterative refinement       x* = U ỹ* + (I-S) z
//   anorm_error = |S (x - x*)|_A / |S x*|_A = |ỹ - ỹ*|_Ã / |ỹ*|_Ã,   |u|_A = sqrt(uᵀ A u)
//
// in the reduced unknowns, since prescribed components would flatter. Refinement (Higham, "Accuracy
// and Stability of Numerical Algorithms", 2nd ed., algorithm 12.1): r = b̃ - Ã ỹ in extended
// precision (long double), Ã d = r by the factor, ỹ += d. sqrt(dᵀ r) is |d|_Ã, the error that ỹ
// had, so it stops when that no longer halves; the ỹ of the smallest such error is kept. The
// factorisation is CHOLMOD's where it is registered, else Eigen's: never one of the solvers being
// measured, though it may share their library.

#include <string>
#include <vector>

#include "taut/solve/linear_system.h"

namespace taut {

struct ReferenceReport {
  // not ok: the factorisation failed, or the right-hand side is not finite
  Status status;
  std::string backend;  // "cholmod", "eigen"
  int refinements = 0;  // corrections that were kept
  // |d|_Ã / |ỹ|_Ã of the last correction: about the A-norm error of what is returned
  double error_estimate = 0.0;
};

// 3N doubles, or empty when report.status is not ok. A failure is about the matrix, so it concerns
// the caller: pass a report.
std::vector<double> reference_solution(const LinearSystem& system, ReferenceReport& report);
std::vector<double> reference_solution(const LinearSystem& system);

// Of x against x_reference, 3N doubles each. With S x* = 0 it is |S x|_A itself.
double anorm_error(const LinearSystem& system, std::span<const double> x,
                   std::span<const double> x_reference);

}  // namespace taut
