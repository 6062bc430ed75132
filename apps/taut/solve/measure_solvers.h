#pragma once
// One system, many solvers: what each of them took and how far from the reference it ended. For `taut solve`.

#include <string>
#include <vector>

#include "taut/solve/reference.h"
#include "taut/solve/solver.h"

namespace taut::app {

struct SolverRow {
  SolveSummary summary;
  double anorm_error = -1.0;  // negative: there is no reference
};

// One point of a convergence history: the iterate after `iteration` iterations.
struct HistoryPoint {
  std::string solver;
  int iteration = 0;
  double stop_value = 0.0;  // sqrt(δ/δ0), what the method's stop test sees
  double residual = 0.0;    // |S(b - A x)| / |S(b - A(I-S)z)|
  double anorm_error = -1.0;
};

struct Reference {
  ReferenceReport report;
  std::vector<double> x;  // empty: none
};
Reference make_reference(const LinearSystem& system);

// `options.name` says which solver.
SolverRow measure_solver(const LinearSystem& system, const SolverOptions& options, const Reference& reference);
// Solves once more, watching each iteration. Empty for a direct method.
std::vector<HistoryPoint> record_history(const LinearSystem& system, const SolverOptions& options, const Reference& reference);

// All solvers of this build, each once: not "mpcg" and "mpcg:diagonal", which are the same.
std::vector<std::string> distinct_solvers();

}  // namespace taut::app
