#pragma once
// The bound of corePCG (docs/mathematics.md, 5) beside what is measured on one system:
//
//   1/(1+ρ) <= λ(P⁻¹A) <= q        cond(P⁻¹A) <= κ = Core::condition()
//   iterations <= iteration_bound(κ, start, tolerance)
//
//   smallest, largest   the extreme eigenvalues of P̃⁻¹Ã, by Lanczos (linalg/lanczos.h); they
//                       approach the true ones from within
//   bound               κ, of largest/smallest
//   rho                 the system's ρ; negative, like `bound` and `bound_iterations`, when the
//                       system does not know it
//   iterations          that corePCG takes from the system's guess to `tolerance`
//
// All zero when the core cannot be factorised. One factorisation, two runs of CG: for benches, not
// for steps.

#include "taut/solve/linear_system.h"

namespace taut {

struct CoreSpectrum {
  double smallest = 0.0, largest = 0.0, bound = -1.0;
  double rho = -1.0;
  int iterations = 0, bound_iterations = -1;
};

CoreSpectrum measure_core_spectrum(const LinearSystem& system, double tolerance);

}  // namespace taut
