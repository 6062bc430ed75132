#pragma once
// corePCG (paper Section 6) on Taut's own block factorisation: the method of solve/core_pcg.h, arranged for speed.
//
//   P = A_core, Ã = Uᵀ A U, P̃ = Uᵀ P U      conjugate gradients on Ã ỹ = b̃, preconditioned by P̃ = L Lᵀ
//
// - Neither Ã nor P̃ is formed: products take A, the factorisation takes A's core blocks, and constrained nodes are looked at one by one
//   (solve/full_space.h).
// - Ordering and symbolic work are done once per topology and core, whatever contacts do and whatever SolverOptions::reuse_analysis
//   says; numbers are fresh in every solve.
// - The stop test needs forward solves only, δ = rᵀ P̃⁻¹ r = |L⁻¹ Uᵀ r|²: δ0 and the first δ come with the factorisation, and the backward
//   solve of the last residual is saved. k iterations take k forward and k backward solves.
// - The factor is in single precision. When a pivot fails there, or the loop takes long and the factor proves wrong along its search
//   directions (wᵀ P̃⁻¹ w = cᵀ w for w = P c, looked at every eighth iteration), the factor is computed anew in double precision and the
//   loop goes on from where it is; the summary counts it.
//
// Stop test and starting point are core_pcg's, so iterations agree with it but for rounding.

#include "taut/linalg/block_cholesky.h"
#include "taut/linalg/krylov.h"
#include "taut/solve/solver.h"

namespace taut {

class CoreFast : public ConstrainedSolver {
 public:
  explicit CoreFast(SolverOptions options) : ConstrainedSolver(std::move(options)) {}

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  bool analyze_if_new(const LinearSystem& system, SolveSummary& summary);
  bool factorize(CholeskyPrecision precision, const LinearSystem& system, SolveSummary& summary);
  void residual(const LinearSystem& system, std::span<const double> x);
  bool begin_in_double(const LinearSystem& system, SolveSummary& summary);
  KrylovResult iterate(const BlockCsr& a, std::span<double> x, int done, int max_iterations, bool watch_factor);
  double factor_quality(const BlockCsr& a);

  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<std::uint8_t> mask_;
  BlockCholesky factor_;
  bool starts_at_rest_ = false;           // no guess: the first residual is the load
  double delta0_ = 0.0, delta_ = 0.0;     // b̂ᵀ P̃⁻¹ b̂, and of the residual at the factorisation
  std::vector<double> load_, r_, c_, q_;  // b̂, residual, direction, its product
};

}  // namespace taut
