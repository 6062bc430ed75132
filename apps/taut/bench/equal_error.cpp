#include "bench/equal_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/solve/reference.h"

namespace taut::app {

namespace {

// Thrown by the observer to leave a solver's loop; the solver is thrown away with it.
struct Enough {};

struct Watched {
  std::array<int, wanted_errors.size()> iterations;
  Status status;
  bool direct = false;
};

SolverOptions options_for(const std::string& solver, double tolerance, int max_iterations) {
  SolverOptions options;
  options.name = solver;
  options.tolerance = tolerance;
  options.max_iterations = max_iterations;
  options.reuse_analysis = false;
  return options;
}

// Runs under the method's stop rule at `tolerance`, until the smallest wanted error is reached or time is up.
Watched watch(const LinearSystem& system, const SolverOptions& options, std::span<const double> reference, double seconds) {
  Watched watched;
  watched.iterations.fill(-1);
  const auto note = [&](int iteration, double error) {
    for (std::size_t e = 0; e < wanted_errors.size(); ++e)
      if (watched.iterations[e] < 0 && error <= wanted_errors[e]) watched.iterations[e] = iteration;
  };
  std::vector<double> x(system.rhs.size());
  const auto solver = make_solver(options);
  const Timer timer;
  solver->observer = [&](int iteration, double, std::span<const double> iterate) {
    note(iteration, anorm_error(system, iterate, reference));
    if (watched.iterations.back() >= 0) throw Enough{};
    if (timer.milliseconds() > 1000.0 * seconds) {
      watched.status = {Outcome::max_iterations, fmt::format("given up after {:g} s and {} iterations", seconds, iteration)};
      throw Enough{};
    }
  };
  try {
    const SolveSummary summary = solver->solve(system, x);
    watched.status = summary.status;
    watched.direct = summary.iterations == 0;
    if (summary.status.ok()) note(summary.iterations, anorm_error(system, x, reference));
  } catch (const Enough&) {
  }
  return watched;
}

double median_of_three(const LinearSystem& system, const SolverOptions& options, std::vector<double>& x, SolveSummary& summary) {
  constexpr double short_ms = 150.0;
  std::vector<double> totals{summary.total_ms()};
  for (int repeat = 0; repeat < 2 && totals[0] < short_ms; ++repeat) totals.push_back(make_solver(options)->solve(system, x).total_ms());
  std::ranges::sort(totals);
  return totals[totals.size() / 2];
}

}  // namespace

EqualErrorResult measure_equal_error(const LinearSystem& system, const std::string& solver, std::span<const double> reference,
                                     double seconds) {
  EqualErrorResult result;
  result.solver = solver;
  double tolerance = wanted_errors.back();
  Watched watched = watch(system, options_for(solver, tolerance, 0), reference, seconds);
  while (watched.iterations.back() < 0 && watched.status.ok() && !watched.direct && tolerance > 1e-15)
    watched = watch(system, options_for(solver, tolerance *= 1e-2, 0), reference, seconds);
  result.status = watched.status;

  const int most = *std::ranges::max_element(watched.iterations);
  std::vector<double> x(system.rhs.size());
  if (most < 0) {  // nothing to time; the set-up alone tells what it holds
    result.summary = make_solver(options_for(solver, tolerance, 1))->solve(system, x);
    return result;
  }
  const SolverOptions timed = options_for(solver, tolerance, std::max(1, most));
  result.summary = make_solver(timed)->solve(system, x);
  result.anorm_error = anorm_error(system, x, reference);
  SolveSummary& s = result.summary;
  // A slow machine moment hits set-up and loop alike.
  const double total = median_of_three(system, timed, x, s), scale = total / s.total_ms();
  for (std::size_t e = 0; e < wanted_errors.size(); ++e) {
    if (watched.iterations[e] < 0) continue;
    const double share = watched.direct ? 1.0 : static_cast<double>(watched.iterations[e]) / std::max(1, s.iterations);
    result.to[e] = {watched.direct ? 0 : watched.iterations[e], scale * (s.total_ms() - s.solve_ms + share * s.solve_ms)};
  }
  if (result.to.back().reached()) result.status = {};
  return result;
}

// "1e-3"
static std::string name_of_error(std::size_t e) { return fmt::format("1e{}", std::lround(std::log10(wanted_errors[e]))); }

void put(nlohmann::ordered_json& row, const EqualErrorResult& result) {
  const SolveSummary& s = result.summary;
  row["solver"] = result.solver;
  row["threads"] = thread_count();
  row["iterations"] = s.iterations;
  row["setup_ms"] = s.total_ms() - s.solve_ms;
  row["solve_ms"] = s.solve_ms;
  row["total_ms"] = s.total_ms();
  if (result.anorm_error >= 0.0) row["anorm_error"] = result.anorm_error;
  row["memory_MB"] = s.memory_bytes / 1e6;
  row["precision"] = s.precision;
  for (std::size_t e = 0; e < wanted_errors.size(); ++e) {
    if (!result.to[e].reached()) continue;
    row["to_" + name_of_error(e) + "_ms"] = result.to[e].ms;
    row["to_" + name_of_error(e) + "_iterations"] = result.to[e].iterations;
  }
  if (!result.status.ok()) row["status"] = name_of(result.status.outcome), row["message"] = result.status.message;
  if (!s.remark.empty()) row["remark"] = s.remark;
}

std::string text_of(const TimeToError& time) {
  if (!time.reached()) return "-";
  return time.iterations > 0 ? fmt::format("{:.1f} (#{})", time.ms, time.iterations) : fmt::format("{:.1f}", time.ms);
}

}  // namespace taut::app
