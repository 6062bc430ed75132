#pragma once
// What callers must know of a solver without knowing which one it is. Said once, where its name is
// registered (solve/solver_registry.h); ConstrainedSolver::traits() and solver_traits(name) tell.
// Fields of the system and of the summary are those of solve/linear_system.h.

#include <string>

namespace taut {

struct SolverTraits {
  // What it does depends on LinearSystem::core.
  bool needs_core = false;
  // ... on LinearSystem::rho and ::stiffness, which a step measures only where they are asked for.
  bool needs_rho = false;
  // Its iterations cannot exceed what ρ says: SolveSummary::bound_iterations.
  bool bounds_iterations = false;
  // It proves how large its error is at most: SolveSummary::error_bound.
  bool proves_error = false;
  // No iterations: what it leaves of the residual is rounding. If much is left, it has failed.
  bool is_direct = false;
  // Its symbolic work is done once per topology, whatever SolverOptions::reuse_analysis says.
  bool keeps_analysis = false;
  // It calls the observer after each of its iterations, if it has any.
  bool shows_iterates = true;
  // SolverOptions::core means "auto" where it is not given, instead of "stretch".
  bool chooses_core = false;
  // The backend of linalg/sparse_cholesky.h that it cannot do without, or empty.
  std::string needs_backend = {};
};

}  // namespace taut
