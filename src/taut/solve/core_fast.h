#pragma once
// corePCG (paper Section 6) on Taut's own block factorisation: the method of solve/core_pcg.h, with
// a better core and arranged for speed.
//
//   P = M + L_C, Ã = Uᵀ A U, P̃ = Uᵀ P U      conjugate gradients on Ã ỹ = b̃, preconditioned by P̃
//                                             = L Lᵀ
//
// - The springs outside the core are taken out of it altogether, where the paper leaves their part
//   of the diagonal: blocks outside are lumped (docs/mathematics.md, 5). So P <= A, smooth motions
//   meet eigenvalues near 1, and the error at the end is proved: error_bound of the summary. For
//   elements of two nodes; done where ρ is known. Where it fails (a pivot of the lumped matrix in
//   double precision), nothing is lumped.
// - Where last step's x was smooth, parallelograms stand in for springs outside the core: the other
//   diagonals of a grid's cells. P <= A is lost then, the bound on the condition is (1 + 4 ρ_Q) (1
//   + 2 ρ_D), and iterations are fewer (docs/mathematics.md, 5, "Stand-ins";
//   core/replacement_choice.h). Needs LinearSystem::last and ::masses.
// - Neither Ã nor P̃ is formed: products take A or blocks of it, the factorisation takes A's core
//   blocks, and constrained nodes are looked at one by one (solve/full_space.h).
// - Ordering and symbolic work are done once per topology and core, whatever contacts do and
//   whatever SolverOptions::reuse_analysis says; numbers are fresh in every solve.
// - Springs outside the core whose block has a place in the factor, by fill-in, enter the core:
//   they cost nothing there, so the core is larger than the paper's and the iterations are fewer.
//   Most shear springs of a grid do. The bound for the smaller core holds.
// - A c = P c + E c, and P c is known: only the blocks of E, outside the core, are multiplied
//   (core/block_remainder.h). So in single precision and where they are lumped; else products take
//   A.
// - The stop test needs forward solves only, δ = rᵀ P̃⁻¹ r = |L⁻¹ Uᵀ r|²: δ0 and the first δ come
//   with the factorisation, and the backward solve of the last residual is saved. k iterations take
//   k forward and k backward solves.
// - It starts from rest, x = (I-S) z, unless the guess is an iterate: last step's x is farther from
//   x than 0 is in most steps (implicit steps turn the stiff part of the velocity change round),
//   and to look at it costs a product and a forward solve.
//
// Precision. The factor is in single precision, and P c is as exact as its solves: after a
// reduction of the error from e0 to e1 the true error is about e1 + η e0. With the unit roundoff u
// = 2⁻²⁴ and σ of LinearSystem::stiffness, measured: η = 0.3 to 3.6 u sqrt(σ) on wrinkled cloth, up
// to 0.21 u σ on a flat sheet that hangs askew, where rounded stretch springs stiffen it across.
// Where 0.22 u (1 + σ) might matter beside the error that the stop test allows, products are taken
// from A: then the factor only preconditions. Else the residual is taken from A itself at 8 u
// sqrt(1 + σ); if it is not what was believed, conjugate gradients begin anew with products from A.
// When a pivot fails, or the loop takes long and the factor proves wrong along its search
// directions (wᵀ P̃⁻¹ w = cᵀ w for w = P c, looked at every eighth iteration), or takes more
// iterations than the bound, the factor is computed anew in double precision and the loop goes on
// from where it is; the summary counts it. Where 0.22 u (1 + σ) is above 2 (h² k/m above 4e7) it is
// in double precision at once.
//
// Stop test: core_pcg's.

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
  double factor_quality(const BlockCsr& a);
  KrylovResult iterate(const LinearSystem& system, std::span<double> x, int done,
                       int max_iterations, bool in_single);

  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<std::uint8_t> mask_;  // of the core that was asked for
  BlockCholesky factor_;
  BlockRemainder remainder_;
  std::vector<BlockRemainder::Ratios> ratios_;  // per batch of it
  bool starts_at_rest_ = false;                 // the first residual is the load
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
