#include "solve/measure_solvers.h"

#include <fmt/format.h>

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

double setup_ms(const SolveSummary& summary) {
  return summary.reduce_ms + summary.order_ms + summary.factor_ms;
}

namespace {

constexpr int trial_iterations = 100;

SolveSummary solve_afresh(const LinearSystem& system, const SolverOptions& options,
                          std::vector<double>& x) {
  return make_solver(options)->solve(system, x);
}

bool ran_out(const SolveSummary& summary) {
  return summary.status.outcome == Outcome::max_iterations;
}

// Solves with as many iterations as the time allows; `options` then says how many these were.
SolveSummary solve_in_time(const LinearSystem& system, SolverOptions& options, double seconds,
                           std::vector<double>& x) {
  const int wanted = options.max_iterations > 0
                         ? options.max_iterations
                         : static_cast<int>(std::min<std::size_t>(
                               1'000'000, std::max<std::size_t>(1000, 10 * x.size())));
  options.max_iterations = std::min(wanted, trial_iterations);
  SolveSummary summary = solve_afresh(system, options, x);
  if (!ran_out(summary) || options.max_iterations == wanted) return summary;
  const double affordable = 1000.0 * seconds * trial_iterations / std::max(1e-3, summary.solve_ms);
  options.max_iterations =
      static_cast<int>(std::clamp<double>(affordable, trial_iterations, wanted));
  if (options.max_iterations > trial_iterations) summary = solve_afresh(system, options, x);
  if (ran_out(summary) && options.max_iterations < wanted)
    summary.status.message += fmt::format(", all that fit into {:g} s (--time-limit)", seconds);
  return summary;
}

// A method's stop rule is in a norm of its own. Where the true residual is asked for, the rule is
// tightened until that is small enough too.
SolveSummary solve_to_residual(const LinearSystem& system, SolverOptions& options,
                               const SolveLimits& limits, std::vector<double>& x) {
  const SolverOptions asked = options;
  SolveSummary summary = solve_in_time(system, options, limits.seconds, x);
  const auto too_large = [&] {
    return limits.residual > 0.0 && summary.status.ok() &&
           summary.relative_residual > limits.residual;
  };
  while (too_large() && summary.iterations > 0 && options.tolerance > 1e-18) {
    const double tighter =
        std::max(1e-18, options.tolerance *
                            std::min(0.1, 0.3 * limits.residual / summary.relative_residual));
    options = asked, options.tolerance = tighter;
    summary = solve_in_time(system, options, limits.seconds, x);
  }
  if (too_large())
    summary.status = {
        Outcome::breakdown,
        fmt::format(
            "it ends by its own rule{}, but the true residual stays at {:.2e}, above {:g}",
            summary.iterations > 0 ? fmt::format(" at tolerance {:g}", options.tolerance) : "",
            summary.relative_residual, limits.residual)};
  if (options.tolerance != asked.tolerance) {
    summary.remark += summary.remark.empty() ? "" : "; ";
    summary.remark += fmt::format("tolerance {:.1g}, for the true residual to come below {:g}",
                                  options.tolerance, limits.residual);
  }
  return summary;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

void take_medians(const LinearSystem& system, const SolveLimits& limits, SolverRow& row) {
  constexpr double short_ms = 200.0;
  row.solves = limits.repeats > 0 ? limits.repeats : row.summary.total_ms() < short_ms ? 5 : 1;
  std::vector<SolveSummary> summaries{row.summary};
  std::vector<double> x(system.rhs.size());
  while (static_cast<int>(summaries.size()) < row.solves)
    summaries.push_back(solve_afresh(system, row.options, x));
  for (double SolveSummary::* time : {&SolveSummary::reduce_ms, &SolveSummary::order_ms,
                                      &SolveSummary::factor_ms, &SolveSummary::solve_ms}) {
    std::vector<double> times;
    for (const SolveSummary& summary : summaries) times.push_back(summary.*time);
    row.summary.*time = median(times);
  }
}

}  // namespace

SolverRow measure_solver(const LinearSystem& system, const SolverOptions& options,
                         const Reference& reference, const SolveLimits& limits) {
  std::vector<double> x(system.rhs.size());
  SolverRow row;
  row.options = options;
  row.summary = solve_to_residual(system, row.options, limits, x);
  row.anorm_error = error_of(system, x, reference);
  take_medians(system, limits, row);
  return row;
}

std::vector<HistoryPoint> record_history(const LinearSystem& system, const SolverRow& row,
                                         const Reference& reference) {
  std::vector<double> x(system.rhs.size());
  const double setup = setup_ms(row.summary),
               each = row.summary.solve_ms / std::max(1, row.summary.iterations);
  const auto point = [&](int iteration, double stop_value, std::span<const double> iterate) {
    return HistoryPoint{row.options.name,
                        iteration,
                        stop_value,
                        relative_residual(system, iterate),
                        error_of(system, iterate, reference),
                        setup + iteration * each};
  };
  initial_guess(system, x);
  std::vector<HistoryPoint> points{point(0, 0.0, x)};
  const auto solver = make_solver(row.options);
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
