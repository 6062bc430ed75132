#pragma once
// Solvers and preconditioners of one's own, by name: what is registered here is made by
// make_solver(), runs in a simulation, is taken by scene files and `--solver`, and is listed and
// suggested like those that Taut has.
//
//   register_solver("own", [](const SolverOptions& o) { return std::make_unique<Own>(o); }, {...})
//   register_preconditioner("own", [](const SolverOptions&) { return std::make_unique<OwnP>(); })
//       gives mpcg:own, upcg:own and ppcg:own, preconditioned by M_p ~
//         upcg         Ã = Uᵀ A U, n x n in blocks of ndof(i) x ndof(j), 0 to 3 each: the pattern
//                      is another one whenever constraints come or go
//         mpcg, ppcg   S A S + d (I-S), 3N x 3N in A's pattern, d a mass per node; of M_p⁻¹ its
//                      part S M_p⁻¹ S counts
//       M_p⁻¹ must be symmetric positive definite (docs/mathematics.md, 3).
//
// At any time before the name is used, from any thread. An empty name, one with blanks or commas,
// or one that is taken is an InputError. What factories return must not be null.

#include <functional>
#include <memory>
#include <string>

#include "taut/linalg/preconditioner.h"
#include "taut/solve/solver.h"

namespace taut {

using SolverFactory = std::function<std::unique_ptr<ConstrainedSolver>(const SolverOptions&)>;
void register_solver(const std::string& name, SolverFactory factory, SolverTraits traits = {});

struct PreconditionerTraits {
  // Made of the matrix core (paper Section 6), constrained as above, in place of A.
  bool of_core = false;
  // Given the rigid motions by set_near_null_space() before each update().
  bool needs_near_null_space = false;
};
using PreconditionerFactory = std::function<std::unique_ptr<Preconditioner>(const SolverOptions&)>;
void register_preconditioner(const std::string& name, PreconditionerFactory factory,
                             PreconditionerTraits traits = {});

// Of a name that is not known: the defaults.
SolverTraits solver_traits(const std::string& name);

}  // namespace taut
