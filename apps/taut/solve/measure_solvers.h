#pragma once
// One system, many solvers: what each of them took and how far from the reference it ended. For
// `taut solve`.

#include <string>
#include <vector>

#include "taut/solve/reference.h"
#include "taut/solve/solver.h"

namespace taut::app {

struct SolveLimits {
  // |S(b - A x)| / |S(b - A(I-S)z)| that a solver must reach to count as converged: its tolerance
  // is made smaller until it does. 0: its own stop rule is enough.
  double residual = 0.0;
  // For one solve; the iterations that fit are found from the first hundred. Direct methods are not
  // stopped.
  double seconds = 60.0;
  // Solves of which the median times are taken. 0: five when one takes less than 0.2 s, else one.
  int repeats = 0;
};

struct SolverRow {
  SolveSummary summary;       // times: medians
  double anorm_error = -1.0;  // negative: there is no reference
  int solves = 1;             // that the medians are of
  SolverOptions options;      // what the last solve was told: see SolveLimits
};

// One point of a convergence history: the iterate after `iteration` iterations.
struct HistoryPoint {
  std::string solver;
  int iteration = 0;
  double stop_value = 0.0;  // sqrt(δ/δ0), what the method's stop test sees
  double residual = 0.0;    // |S(b - A x)| / |S(b - A(I-S)z)|
  double anorm_error = -1.0;
  // set-up included: the row's median times, shared out evenly over its iterations
  double time_ms = 0.0;
};

struct Reference {
  ReferenceReport report;
  std::vector<double> x;  // empty: none
};
Reference make_reference(const LinearSystem& system);

// `options.name` says which solver.
SolverRow measure_solver(const LinearSystem& system, const SolverOptions& options,
                         const Reference& reference, const SolveLimits& limits);
// Solves once more, watching each iteration. Empty for a direct method.
std::vector<HistoryPoint> record_history(const LinearSystem& system, const SolverRow& row,
                                         const Reference& reference);

double setup_ms(const SolveSummary& summary);  // reduction, ordering, factorisation

// All solvers of this build, each once: not "mpcg" and "mpcg:diagonal", which are the same.
std::vector<std::string> distinct_solvers();

}  // namespace taut::app
