#pragma once
// PCG on a reduced system, its result put into a SolveSummary; used by every solver that reduces
// first.

#include "taut/linalg/pcg.h"
#include "taut/solve/reduced_system.h"
#include "taut/solve/solver.h"

namespace taut {

using SolveObserver = std::function<void(int, double, std::span<const double>)>;

// Solves Ã ỹ = b̃ in place in reduced.solution(), prolongs into x and fills status, iterations and
// the stop test's values.
void reduced_pcg(const LinearSystem& system, ReducedSystem& reduced, const Preconditioner& m,
                 double tolerance, int max_iterations, const SolveObserver& observer,
                 std::span<double> x, SolveSummary& summary,
                 CgCoefficients* coefficients = nullptr);

// Copies a Krylov result into the summary.
void take_over(const KrylovResult& result, SolveSummary& summary);

}  // namespace taut
