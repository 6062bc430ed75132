#pragma once
// corePCG (paper Section 6) on Taut's own block factorisation: the method of solve/core_pcg.h, with
// a better core and arranged for speed. docs/design/core-fast.md says how and why.
//
//   Ã = Uᵀ A U, P̃ = Uᵀ P U       conjugate gradients on Ã ỹ = b̃, preconditioned by P̃ = L Lᵀ
//   P = M + L_C                  without the elements outside the core: P <= A, so that the error
//                                is proved (error_bound). Where ρ is known; else as in core_pcg
//   cond(P⁻¹A) <= κ              Core::condition(); (1 + 4 ρ_Q) (1 + 2 ρ_D) where parallelograms
//                                stand in for springs (docs/mathematics.md, 5)
//
// The factor is in single precision where that holds, else in double precision: the summary says
// which, and counts falls from one to the other. Stop test: core_pcg's.

#include "taut/core/block_remainder.h"
#include "taut/linalg/block_cholesky.h"
#include "taut/linalg/krylov.h"
#include "taut/solve/solver.h"

namespace taut {

class CoreFast : public ConstrainedSolver {
 public:
  explicit CoreFast(SolverOptions options) : ConstrainedSolver(std::move(options)) {}

  static constexpr double unknown_rounding = 2e-3;

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  bool analyze_if_new(const LinearSystem& system, SolveSummary& summary);
  void start(const LinearSystem& system, std::span<double> x);
  bool factorize(CholeskyPrecision precision, const LinearSystem& system, SolveSummary& summary);
  void residual(const LinearSystem& system, std::span<const double> x);
  bool begin_in_double(const LinearSystem& system, bool single_has_failed, SolveSummary& summary);
  void take_outside(const LinearSystem& system);
  void bound_replaced();
  double factor_quality(const LinearSystem& system);
  // Whose blocks P is made of.
  const BlockCsr& core_of(const LinearSystem& system) const;
  KrylovResult iterate(const LinearSystem& system, std::span<double> x, int done,
                       int max_iterations, bool in_single);

  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<std::uint8_t> mask_;  // of the core that was asked for
  BlockCholesky factor_;
  BlockRemainder remainder_;
  std::vector<BlockRemainder::Ratios> ratios_;  // per batch of it
  bool starts_at_rest_ = false;                 // the first residual is the load
  bool has_matrix_ = false;                     // P is Core::matrix
  bool lumped_ = false;                         // P is without the springs outside the core
  bool replaced_ = false;                       // ... and with parallelograms for some of them
  double condition_ = -1.0;      // what cond(P⁻¹A) cannot exceed; negative: not known
  double excess_ = 1.0;          // P <= excess A
  bool knows_products_ = false;  // the remainder has been taken from the matrix
  // b̂ᵀ P̃⁻¹ b̂, and of the residual at the factorisation
  double delta0_ = 0.0, delta_ = 0.0;
  double energy_ = 0.0;       // |x - x0|_A² that the loop has found
  int bound_iterations_ = 0;  // of the parts of the loop so far
  // b̂ (where it is not the first residual), residual, direction, its products with P and A
  std::vector<double> load_, r_, c_, p_, q_;
};

}  // namespace taut
