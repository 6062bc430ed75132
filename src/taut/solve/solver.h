#pragma once
// A method for the constrained linear system of a step (solve/linear_system.h), made by name:
//
//   S A x = S b,  (I - S) x = (I - S) z
//
//   make_solver({.name = "upcg:ic0"})   METHOD or METHOD:VARIANT; METHOD alone is its first
//                                       variant. docs/solvers.md: what they are, which one when
//   solve(system, x)                    fills x (3N doubles), says what happened
//   solve_again(system, x)              another right-hand side, on the last factor if any
//
// Never throws for numerical reasons: where the summary's status is not ok, x holds the best
// iterate, or S guess + (I-S) z if there is none. A solver keeps memory and, where allowed,
// symbolic work between calls. One object, one thread at a time. One's own: derive, write run(),
// and register it (solve/solver_registry.h).

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "taut/linalg/krylov.h"
#include "taut/solve/linear_system.h"
#include "taut/solve/solver_options.h"
#include "taut/solve/solver_traits.h"

namespace taut {

class ConstrainedSolver {
 public:
  virtual ~ConstrainedSolver() = default;

  // Solves and checks: the summary has the true residual.
  SolveSummary solve(const LinearSystem& system, std::span<double> x);
  // The system of the last solve() once more, with other rhs, z or guess. The caller promises that
  // matrix, its values and constraints are the same: the true residual shows where they are not.
  // Methods without a factor to keep, and all after a failure, solve afresh.
  SolveSummary solve_again(const LinearSystem& system, std::span<double> x);

  // Of the name it was made by.
  const SolverTraits& traits() const { return traits_; }

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
  // Fills x and of the summary the status and what the method knows of iterations, times, memory.
  virtual void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) = 0;
  // The same for solve_again(), after a run() that has succeeded.
  virtual void run_again(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
    run(system, x, summary);
  }
  // run() of another solver, for one made of several.
  static void run_other(ConstrainedSolver& other, const LinearSystem& system, std::span<double> x,
                        SolveSummary& summary) {
    other.run(system, x, summary);
  }
  int iteration_limit(Index unknowns) const;
  // Whether the last answer is a direct method's, which stops whatever the residual is: on a
  // singular matrix, whose last pivot is rounding, it would succeed with any x.
  virtual bool is_direct() const { return traits_.is_direct; }

  SolverOptions options_;

 private:
  friend std::unique_ptr<ConstrainedSolver> make_solver(const SolverOptions& options);
  using Run = void (ConstrainedSolver::*)(const LinearSystem&, std::span<double>, SolveSummary&);
  SolveSummary checked(Run method, const LinearSystem& system, std::span<double> x);

  SolverTraits traits_;
  bool has_solved_ = false;  // the last time
};

// Throws InputError with the list of names when options.name is unknown, or known but not built in.
std::unique_ptr<ConstrainedSolver> make_solver(const SolverOptions& options);
// All names that make_solver takes in this build, default variants without suffix.
std::vector<std::string> solver_names();
// True for a name that would be known in a complete build (scene files are checked against this).
bool is_solver_name(const std::string& name);

// S guess + (I-S) z into x.
void initial_guess(const LinearSystem& system, std::span<double> x);

}  // namespace taut
