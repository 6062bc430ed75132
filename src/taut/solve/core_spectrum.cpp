#include "taut/solve/core_spectrum.h"

#include <algorithm>
#include <cassert>

#include "taut/core/core_bound.h"
#include "taut/linalg/factor_preconditioner.h"
#include "taut/linalg/lanczos.h"
#include "taut/linalg/pcg.h"
#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/reduced_system.h"

namespace taut {

namespace {

// An end of the spectrum of which the start holds little is found late.
constexpr double lanczos_tolerance = 1e-30;
constexpr int most_lanczos_steps = 1000;

// Numbers without any symmetry, so that the start has a part along every eigenvector.
std::vector<double> start_vector(std::size_t n) {
  std::vector<double> b(n);
  std::uint64_t state = 0x9e3779b97f4a7c15ull;
  for (double& value : b) {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    value = static_cast<double>(state >> 11) * 0x1p-52 - 1.0;
  }
  return b;
}

SpectrumEnds ends(const BlockCsr& a, const Preconditioner& m) {
  const std::vector<double> b = start_vector(static_cast<std::size_t>(a.dofs()));
  std::vector<double> x(b.size(), 0.0);
  CgCoefficients coefficients;
  pcg(BlockCsrOperator(a), m, b, x, {lanczos_tolerance, most_lanczos_steps, {}, &coefficients});
  return spectrum_ends(coefficients);
}

}  // namespace

CoreSpectrum measure_core_spectrum(const LinearSystem& system, double tolerance) {
  CoreSpectrum result;
  ReducedSystem reduced;
  Reduction core;
  reduced.update(system);
  BlockCsr own_core;
  core.update(core_matrix(system, own_core), system.constraints, core_mask(system));
  const std::unique_ptr<SparseCholesky> factor = make_cholesky("block");
  if (!factor->analyze(core.matrix()).ok() || !factor->factorize(core.matrix()).ok()) return result;
  const FactorPreconditioner m(*factor, false);
  const auto [smallest, largest] = ends(reduced.matrix(), m);
  result.smallest = smallest, result.largest = largest;

  const int limit =
      std::max(1000, 10 * static_cast<int>(std::min(reduced.matrix().dofs(), Index{100000})));
  const KrylovResult solve = pcg(BlockCsrOperator(reduced.matrix()), m, reduced.rhs(),
                                 reduced.solution(), {tolerance, limit, {}});
  result.iterations = solve.iterations;
  if (system.core.rho < 0.0) return result;
  result.rho = system.core.rho;
  result.bound = system.core.condition();
  result.bound_iterations = iteration_bound(result.bound, solve.start_value, tolerance);
  return result;
}

}  // namespace taut
