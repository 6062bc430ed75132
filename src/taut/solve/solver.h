#pragma once
// Solvers of the constrained linear system, by name ("METHOD" or "METHOD:VARIANT"):
//
//   mpcg[:PRECONDITIONER]                modified PCG on (A, S, z): Baraff & Witkin 1998, as
//                                        corrected by Ascher & Boxerman 2003 (paper
//   Section 2) upcg[:PRECONDITIONER]                plain PCG on the reduced Ã (Section 3)
//                                                   ppcg[:PRECONDITIONER] pre-filtered PCG on S A S
//   + d (I-S): size and pattern of A kept (Tamstorf et al. 2015)
//      diagonal, block_diagonal          of A, restricted to the free directions: mpcg and upcg
//                                        then agree step by step
//      projected_block_diagonal          the diagonal blocks of Ã (Boxerman & Ascher 2004); ppcg
//                                        calls its own block_diagonal
//      reduced_diagonal                  upcg: diag(Ã), which depends on the choice of U
//      ic0, ic0_core                     incomplete Cholesky on node blocks, of Ã or of the matrix
//                                        core (linalg/incomplete_cholesky.h)
//      ssor                              symmetric Gauss-Seidel, or SolverOptions::ssor_omega
//                                        (linalg/ssor.h)
//      amg                               upcg, ppcg: smoothed aggregation with the rigid motions
//                                        (linalg/smoothed_aggregation.h)
//   eq10[:block_diagonal|:ilu0]          BiCGSTAB on S A + d (I-S), the paper's Eq. 10, which is
//                                        equivalent after all
//   cholmod, pardiso, eigen_ldlt         direct: sparse Cholesky of Ã (Section 4)
//   cholmod_reused_analysis              cholmod, its analysis kept while the reduced pattern
//                                        stays, whatever the options say
//   pardiso_cgs                          PARDISO's own CG on the factor of an earlier step, its
//                                        "Pardiso(2)" (Table 2); library
//   taut_pardiso block_cholesky                       direct: Taut's own factorisation of Ã
//                                                     (linalg/block_cholesky.h) core_fast
//                                                     core_pcg's
//   method on that factorisation, in single precision where it holds (solve/core_fast.h)
//   core_pcg[:cholmod|:eigen|:pardiso|:block]   PCG on
//   Ã, preconditioned by the factorised matrix core (Section 6) auto
//   chooses among the others from step to step, by counted work (solve/auto_solver.h)
//
// d: a mass per node, the mean of A's diagonal there, so that kilograms are not added to pure
// numbers. Without :VARIANT the first one listed is meant; core_pcg falls back from cholmod to
// eigen when CHOLMOD is not built in, and says so in the summary's remark. A solver keeps memory
// and, where allowed, symbolic work between calls. One object, one thread at a time.

#include <functional>
#include <memory>
#include <vector>

#include "taut/linalg/krylov.h"
#include "taut/solve/linear_system.h"
#include "taut/solve/solver_options.h"

namespace taut {

class ConstrainedSolver {
 public:
  virtual ~ConstrainedSolver() = default;

  // Solves and checks: fills x (3N) and returns what happened, with the true residual. Never throws
  // for numerical reasons; when the status is not ok, x holds the best iterate, or S guess + (I-S)
  // z if there is none.
  SolveSummary solve(const LinearSystem& system, std::span<double> x);

  // Called by iterative methods after each iteration with (iteration, stop value, x in full space);
  // for histories. It slows the loop down.
  std::function<void(int, double, std::span<const double>)> observer;
  // Conjugate gradients on Ã (upcg, core_pcg) leave their coefficients here, unless null.
  CgCoefficients* coefficients = nullptr;
  // For the solves to come, instead of what the options say.
  void set_limits(double tolerance, int max_iterations) {
    options_.tolerance = tolerance, options_.max_iterations = max_iterations;
  }

  // What later choices depend on, beside the system itself: a solver that is given the memory of
  // another takes the same way to the same bits. Empty for all but `auto`.
  virtual std::vector<double> memory() const { return {}; }
  // Empty: as new. Throws InputError when it is not from this solver.
  virtual void restore_memory(std::span<const double> memory);

 protected:
  explicit ConstrainedSolver(SolverOptions options) : options_(std::move(options)) {}
  virtual void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) = 0;
  // run() of another solver, for one made of several.
  static void run_other(ConstrainedSolver& other, const LinearSystem& system, std::span<double> x,
                        SolveSummary& summary) {
    other.run(system, x, summary);
  }
  int iteration_limit(Index unknowns) const;
  // A direct method stops whatever the residual is: on a singular matrix, whose last pivot is
  // rounding, it would succeed with any x.
  virtual bool is_direct() const { return false; }

  SolverOptions options_;
};

// Throws InputError with the list of names when options.name is unknown, or known but not built in.
std::unique_ptr<ConstrainedSolver> make_solver(const SolverOptions& options);
// For a solver that is in the list but whose code is in a library outside libtaut. Not while
// solvers are being made.
using SolverFactory = std::function<std::unique_ptr<ConstrainedSolver>(const SolverOptions&)>;
void register_solver(const std::string& name, SolverFactory factory);
// All names that make_solver takes in this build, default variants without suffix.
std::vector<std::string> solver_names();
// True for a name that would be known in a complete build (scene files are checked against this).
bool is_solver_name(const std::string& name);

// S guess + (I-S) z into x.
void initial_guess(const LinearSystem& system, std::span<double> x);

}  // namespace taut
