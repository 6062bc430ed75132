#pragma once
// The solvers that Taut itself has: what the registry (solve/solver_registry.h) begins with.

#include <vector>

#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/solver_registry.h"

namespace taut {

struct SolverEntry {
  std::string name;
  SolverFactory make;  // empty: the name is kept for a library outside libtaut, which registers it
  SolverTraits traits = {};
};

// In the order of lists.
std::vector<SolverEntry> builtin_solvers();

// METHOD:NAME for every method that the preconditioner is for.
std::vector<SolverEntry> preconditioned_solvers(const NamedPreconditioner& preconditioner);

}  // namespace taut
