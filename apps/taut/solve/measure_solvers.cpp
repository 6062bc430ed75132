#include "solve/measure_solvers.h"

#include <algorithm>

namespace taut::app {

Reference make_reference(const LinearSystem& system) {
  Reference reference;
  reference.x = reference_solution(system, reference.report);
  return reference;
}

namespace {

double error_of(const LinearSystem& system, std::span<const double> x, const Reference& reference) {
  return reference.x.empty() ? -1.0 : anorm_error(system, x, reference.x);
}

}  // namespace

SolverRow measure_solver(const LinearSystem& system, const SolverOptions& options, const Reference& reference) {
  std::vector<double> x(system.rhs.size());
  SolverRow row;
  row.summary = make_solver(options)->solve(system, x);
  row.anorm_error = error_of(system, x, reference);
  return row;
}

std::vector<HistoryPoint> record_history(const LinearSystem& system, const SolverOptions& options, const Reference& reference) {
  std::vector<double> x(system.rhs.size());
  const auto point = [&](int iteration, double stop_value, std::span<const double> iterate) {
    return HistoryPoint{options.name, iteration, stop_value, relative_residual(system, iterate), error_of(system, iterate, reference)};
  };
  initial_guess(system, x);
  std::vector<HistoryPoint> points{point(0, 0.0, x)};
  const auto solver = make_solver(options);
  solver->observer = [&](int iteration, double stop_value, std::span<const double> iterate) {
    points.push_back(point(iteration, stop_value, iterate));
  };
  points.front().stop_value = solver->solve(system, x).start_value;
  if (points.size() == 1) points.clear();
  return points;
}

std::vector<std::string> distinct_solvers() {
  std::vector<std::string> distinct;
  std::string plain;  // the last name without a variant
  for (const std::string& name : solver_names()) {
    // The first variant listed after a plain name is what the plain name means.
    const bool same_again = !plain.empty() && name.starts_with(plain + ":");
    if (!same_again) distinct.push_back(name);
    plain = name.find(':') == std::string::npos ? name : "";
  }
  return distinct;
}

}  // namespace taut::app
