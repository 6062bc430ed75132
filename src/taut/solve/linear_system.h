#pragma once
// The constrained linear system of one step (paper Eq. 5, 6), as every solver of this room receives
// it:
//
//   S A x = S b,   (I - S) x = (I - S) z
//
//   matrix       A, symmetric positive definite, 3N x 3N in 3x3 blocks (without constraints: any
//                dims)
//   rhs          b, 3N doubles
//   constraints  S and U; null: none
//   z            3N doubles, the prescribed part of x (its free part is ignored); may be empty
//                without constraints
//   guess        3N doubles, last step's x, or empty; iterative methods start at S guess + (I-S) z
//                (Ascher & Boxerman 2003)
//   guess_is_iterate    the guess is no last step's x but one for this very system: Newton's last,
//                       or what another method has left
//   last         3N doubles, last step's x, or empty: nobody starts there, it only tells how smooth
//                x may be (core/replacement_choice.h)
//   stiffness    σ, what the elements can add to a node's diagonal block, relative to its mass:
//                |A_ii| <= (1 + σ) m_i; tells how exact a factor in single precision is
//                (solve/core_fast.h). Negative: not known
//   masses       N doubles, kg, those that ρ is relative to; or empty
//   positions    3N doubles, m, where the nodes are; or empty. Only multigrid uses them: for the
//                rotations in its near-null space
//   core         one byte per block of A, 1 for the blocks of the matrix core (paper Section 6);
//                empty: only block-diagonal blocks
//   rho          ρ of docs/mathematics.md, 5 for that core: what the blocks outside it add to the
//                diagonal, relative to the masses; bounds corePCG's iterations. Negative: not known
//   stretch_core, unbent_core    other cores and their ρ, where `core` is a third, else empty: the
//                                paper's, and all but what only bending couples.
//                `auto` tries them
// Units: A kg, b N s, x m/s when x is a velocity change; A kg, b kg m, x m when it is a
// displacement (BDF2).

#include <cstdint>
#include <span>
#include <string>

#include "taut/base/status.h"
#include "taut/constraint/constraint_set.h"
#include "taut/linalg/block_csr.h"

namespace taut {

// A core's mask and ρ, as LinearSystem::core and ::rho.
struct OtherCore {
  std::span<const std::uint8_t> mask;
  double rho = -1.0;
};

struct LinearSystem {
  const BlockCsr* matrix = nullptr;
  std::span<const double> rhs;
  const ConstraintSet* constraints = nullptr;
  std::span<const double> z;
  std::span<const double> guess;
  bool guess_is_iterate = false;
  std::span<const double> last;
  double stiffness = -1.0;
  std::span<const double> masses;
  std::span<const double> positions;
  std::span<const std::uint8_t> core;
  double rho = -1.0;
  OtherCore stretch_core, unbent_core;
};

// Which springs the core of a solve had: LinearSystem::core, one of the others, or all of them.
enum class CoreUsed { own, stretch, unbent, all };

// What a solve did. Times in milliseconds.
struct SolveSummary {
  std::string solver;
  std::string method;  // the solver itself, or what `auto` chose
  Status status;
  int iterations = 0;        // 0 for direct methods
  double stop_value = 0.0;   // iterative: sqrt(δ/δ0) at the end (residual ratio for BiCGSTAB)
  double start_value = 0.0;  // the same for the initial guess
  // |error|_A / |x|_A at the end is no larger (core_fast, from rest); negative: not known
  double error_bound = -1.0;
  // core PCG: what they cannot exceed (core/core_bound.h); -1: no bound known
  int bound_iterations = -1;
  // true one, recomputed from A, b, x: |S(b - A x)| / |S(b - A(I-S)z)|; not what the method
  // believes
  double relative_residual = 0;
  double reduce_ms = 0.0;  // forming Ã, b̃ and the core
  double order_ms = 0.0;   // analysis (ordering and symbolic work)
  double factor_ms = 0.0;  // numerical factorisation or other set-up of the preconditioner
  double solve_ms = 0.0;   // the loop, or the triangular solves
  // entries of the sparse Cholesky factor, and operations to form it; 0 where there is none
  double factor_nonzeros = 0.0;
  double factor_flops = 0.0;
  // of A outside the core as it was factorised; negative: the method does not tell
  double left_out_nonzeros = -1.0;
  // of the preconditioner: more than one where IC(0) had to find a shift
  int preparations = 1;
  CoreUsed core = CoreUsed::own;  // of a method that has one
  // of the factor that the answer came from: "single" or "double"
  const char* precision = "double";
  // times that single precision, or a method that `auto` tried first, failed and another took over
  int fallbacks = 0;
  double memory_bytes = 0.0;  // what the method holds beyond A and the vectors
  // core_fast: parallelograms stood in for springs outside the core
  bool replaced = false;
  std::string remark;  // "on eigen: CHOLMOD is not built in", ...
  double total_ms() const { return reduce_ms + order_ms + factor_ms + solve_ms; }
};

// |S(b - A(I-S)z)| (0 when nothing drives the system) and the relative residual of x as above.
double driving_norm(const LinearSystem& system);
double relative_residual(const LinearSystem& system, std::span<const double> x);

}  // namespace taut
