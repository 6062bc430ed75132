#pragma once
// The constrained linear system of one step (paper Eq. 5, 6), as every solver of this room receives
// it, and what a solve did:
//
//   S A x = S b,   (I - S) x = (I - S) z
//
//   A  kg, symmetric positive definite, 3N x 3N in 3x3 blocks (without constraints: any dims)
//   b  N s and x m/s when x is a velocity change; kg m and m when it is a displacement (BDF2)
//   z  the prescribed part of x;   S, U: constraint/constraint_set.h
//
// Vectors have 3N doubles; what need not be there is empty.

#include <span>
#include <string>
#include <vector>

#include "taut/base/status.h"
#include "taut/constraint/constraint_set.h"
#include "taut/core/core.h"
#include "taut/linalg/block_csr.h"

namespace taut {

struct LinearSystem {
  const BlockCsr* matrix = nullptr;            // A
  std::span<const double> rhs;                 // b
  const ConstraintSet* constraints = nullptr;  // null: none
  std::span<const double> z;                   // its free part is ignored
  // Last step's x: iterative methods start at S guess + (I-S) z (Ascher & Boxerman 2003).
  std::span<const double> guess;
  // The guess is no last step's x but one for this very system: Newton's last, or what another
  // method has left.
  bool guess_is_iterate = false;
  // Last step's x. Nobody starts there, it only tells how smooth x may be
  // (core/replacement_choice.h).
  std::span<const double> last;
  // σ, what the elements can add to a node's diagonal block, relative to its mass: |A_ii| <=
  // (1 + σ) m_i. It tells how exact a factor in single precision is. Negative: not known.
  double stiffness = -1.0;
  std::span<const double> masses;  // N, kg: those that the core's ρ is relative to
  // m, where the nodes are. Only multigrid uses them: for the rotations in its near-null space.
  std::span<const double> positions;
  Core core;
  // Others that `auto` may try. Each keeps its place in the list from step to step, with an empty
  // mask where another is as good.
  std::vector<Core> other_cores;
};

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
  double condition = -1.0;  // ... and what cond(P⁻¹A) cannot; negative: not known
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
  // of A outside the core as it was factorised, or all of A's where products read these; negative:
  // the method does not tell
  double left_out_nonzeros = -1.0;
  // of the preconditioner: more than one where IC(0) had to find a shift
  int preparations = 1;
  std::string core;  // Core::name, of a method that has one
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
