#pragma once
// The paper's "Pardiso(2)": a factor of the reduced matrix is kept from step to step, and PARDISO's
// own conjugate gradients use it as preconditioner (iparm[3] = 10 L + 2). Where they fail, PARDISO
// factorises the new matrix by itself and keeps that factor.
//
//   L           ceil(-log10(tolerance)), 1 to 15: PARDISO stops at |dx_i| / |dx_0| < 10^-L, dx the
//               correction that the preconditioner gives; the fewest digits no looser than asked
//   iterations  of CG on the kept factor; 0 where the matrix was factorised
//   factor_ms   of factorisation and solve, which PARDISO then does in one call, and of CG in vain
//   remark      why a kept factor was given up: other pattern, or a fall-back (with their count)
//
// A new pattern of Ã (other constraints) is analysed and factorised anew. PARDISO's limit is 150
// iterations, whatever max_iterations says; initial guess and observer are not used. Not
// reproducible: PARDISO gives CG up when factorising seems faster to it, and asks a clock; oneMKL
// has no setting against this.

#include "taut/solve/reduced_system.h"
#include "taut/solve/solver.h"

namespace taut {

class PardisoFactor;

class PardisoCgs : public ConstrainedSolver {
 public:
  explicit PardisoCgs(SolverOptions options);
  ~PardisoCgs() override;

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  void solve_reduced(SolveSummary& summary);

  std::unique_ptr<PardisoFactor> factor_;
  ReducedSystem reduced_;
  bool has_factor_ = false;
  int systems_ = 0, fallbacks_ = 0;
};

}  // namespace taut
