#pragma once
// The extreme eigenvalues of M⁻¹ A from a run of conjugate gradients. With the coefficients α_k,
// β_k of its iterations,
//
//   T_kk = 1/α_k + β_(k-1)/α_(k-1)        T_k,k+1 = T_k+1,k = sqrt(β_k)/α_k
//
// is the Lanczos tridiagonal of M^(-½) A M^(-½) from the start M^(-½) r_0 (Golub & Van Loan,
// "Matrix Computations", 4th ed., 11.3.5). Its eigenvalues lie within the spectrum; the outermost
// reach it first. Lost orthogonality repeats those that have converged, and does no more harm: CG's
// own residual goes on shrinking, whatever that of x does, so its tolerance may be 1e-30, to find
// the ends of which r_0 holds little.

#include "taut/linalg/krylov.h"

namespace taut {

struct SpectrumEnds {
  double smallest = 0.0, largest = 0.0;
};

// 0, 0 when there is no iteration.
SpectrumEnds spectrum_ends(const CgCoefficients& coefficients);

}  // namespace taut
