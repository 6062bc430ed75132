#include "bench/equal_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "bench/quiet.h"
#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/solve/linear_system.h"
#include "taut/solve/reference.h"

namespace taut::app {

namespace {

// Thrown by the observer to leave a solver's loop; the solver is thrown away with it.
struct Enough {};

struct Watched {
  std::array<int, wanted_errors.size()> iterations;
  // the stop test's least value there, and an iteration earlier
  std::array<double, wanted_errors.size()> stop{}, before{};
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

// Runs under the method's stop rule at `tolerance`, until the smallest wanted error is reached or
// time is up.
Watched watch(const LinearSystem& system, const SolverOptions& options,
              std::span<const double> reference, double seconds) {
  Watched watched;
  watched.iterations.fill(-1);
  double least = 1.0;
  const auto note = [&](int iteration, double stop, double error) {
    const double before = std::exchange(least, std::min(least, stop));
    for (std::size_t e = 0; e < wanted_errors.size(); ++e)
      if (watched.iterations[e] < 0 && error <= wanted_errors[e])
        watched.iterations[e] = iteration, watched.stop[e] = least, watched.before[e] = before;
  };
  std::vector<double> x(system.rhs.size());
  const auto solver = make_solver(options);
  // From the first iteration on: what is done once per topology takes longer than the limit at a
  // million nodes.
  std::optional<Timer> timer;
  solver->observer = [&](int iteration, double stop, std::span<const double> iterate) {
    if (!timer) timer.emplace();
    note(iteration, stop, anorm_error(system, iterate, reference));
    if (watched.iterations.back() >= 0) throw Enough{};
    if (timer->milliseconds() > 1000.0 * seconds) {
      watched.status = {Outcome::max_iterations,
                        fmt::format("given up after {:g} s and {} iterations", seconds, iteration)};
      throw Enough{};
    }
  };
  try {
    const SolveSummary summary = solver->solve(system, x);
    watched.status = summary.status;
    watched.direct = summary.iterations == 0;
    if (summary.status.ok())
      note(summary.iterations, summary.stop_value, anorm_error(system, x, reference));
  } catch (const Enough&) {
  }
  return watched;
}

// The error asked for, or what is nearest to it and ends in the same iteration (below what is
// reached there, the limit of iterations ends it).
double tolerance_for(const Watched& watched, std::size_t e) {
  return std::max(
      {1e-15, std::min(wanted_errors[e], 0.99 * watched.before[e]), 0.99 * watched.stop[e]});
}

// Of as many solves as take a second, at least five: of a machine that others use, a few
// milliseconds tell little. One where it takes long.
SolveSummary median_solve(ConstrainedSolver& solver, const LinearSystem& system,
                          std::vector<double>& x) {
  constexpr double enough_ms = 1000.0, long_ms = 5000.0;
  constexpr double least = 5, most = 41;
  std::vector<SolveSummary> solves;
  const auto wanted = [&] {
    if (solves.empty() || solves[0].total_ms() > long_ms) return 1.0;
    return std::clamp(enough_ms / std::max(solves[0].total_ms(), 1e-3), least, most);
  };
  wait_for_quiet(*system.matrix);
  while (static_cast<double>(solves.size()) < wanted()) solves.push_back(solver.solve(system, x));
  std::ranges::sort(solves, {}, &SolveSummary::total_ms);
  return solves[solves.size() / 2];
}

// Set-up, and of the loop the share until the error was reached.
TimeToError time_to(int iterations, bool direct, const SolveSummary& s) {
  if (direct) return {0, s.total_ms()};
  return {iterations,
          s.total_ms() - s.solve_ms + s.solve_ms * iterations / std::max(1, s.iterations)};
}

// `auto` in a simulation: some solves to look around, then one that is watched and others that are
// timed.
EqualErrorResult measure_auto(const LinearSystem& system, std::span<const double> reference) {
  constexpr int warm_up = 8;
  EqualErrorResult result;
  result.solver = "auto";
  std::vector<double> x(system.rhs.size());
  for (std::size_t e = 0; e < wanted_errors.size(); ++e)
    for (double tolerance = wanted_errors[e]; tolerance > 1e-15 && !result.to[e].reached();
         tolerance *= 0.1) {
      const auto solver = make_solver(options_for("auto", tolerance, 0));
      for (int solve = 0; solve < warm_up; ++solve) solver->solve(system, x);
      int iterations = -1;
      solver->observer = [&](int iteration, double, std::span<const double> iterate) {
        if (iterations < 0 && anorm_error(system, iterate, reference) <= wanted_errors[e])
          iterations = iteration;
      };
      const SolveSummary watched = solver->solve(system, x);
      solver->observer = {};
      result.status = watched.status;
      result.anorm_error = anorm_error(system, x, reference);
      if (!watched.status.ok() || result.anorm_error > wanted_errors[e]) continue;
      result.summary = median_solve(*solver, system, x);
      result.to[e] = time_to(std::max(iterations, 0), iterations < 0, result.summary);
    }
  if (result.to.back().reached()) result.status = {};
  return result;
}

}  // namespace

EqualErrorResult measure_equal_error(const LinearSystem& system, const std::string& solver,
                                     std::span<const double> reference, double seconds) {
  if (solver == "auto") return measure_auto(system, reference);
  EqualErrorResult result;
  result.solver = solver;
  double tolerance = wanted_errors.back();
  Watched watched = watch(system, options_for(solver, tolerance, 0), reference, seconds);
  while (watched.iterations.back() < 0 && watched.status.ok() && !watched.direct &&
         tolerance > 1e-15)
    watched = watch(system, options_for(solver, tolerance *= 1e-2, 0), reference, seconds);
  result.status = watched.status;

  const int most = *std::ranges::max_element(watched.iterations);
  std::vector<double> x(system.rhs.size());
  if (most < 0) {  // nothing to time; the set-up alone tells what it holds
    result.summary = make_solver(options_for(solver, tolerance, 1))->solve(system, x);
    return result;
  }
  // What a method does once per topology is done in a first solve, which is not timed.
  const auto timed = make_solver(options_for(solver, tolerance, std::max(1, most)));
  timed->solve(system, x);
  for (std::size_t e = 0; e < wanted_errors.size(); ++e) {
    const int iterations = watched.iterations[e];
    if (iterations < 0) continue;
    if (e == 0 || (!watched.direct && iterations != watched.iterations[e - 1])) {
      // As if asked for just this: what a method does for a smaller tolerance is not part of it.
      timed->set_limits(tolerance_for(watched, e), std::max(1, iterations));
      result.summary = median_solve(*timed, system, x);
    }
    result.to[e] = time_to(iterations, watched.direct, result.summary);
  }
  result.anorm_error = anorm_error(system, x, reference);
  if (result.to.back().reached()) result.status = {};
  return result;
}

// "1e-3"
static std::string name_of_error(std::size_t e) {
  return fmt::format("1e{}", std::lround(std::log10(wanted_errors[e])));
}

void put(nlohmann::ordered_json& row, const EqualErrorResult& result) {
  const SolveSummary& s = result.summary;
  row["solver"] = result.solver;
  if (s.method != s.solver) row["method"] = s.method;
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
  if (!result.status.ok())
    row["status"] = name_of(result.status.outcome), row["message"] = result.status.message;
  if (!s.remark.empty()) row["remark"] = s.remark;
}

std::string text_of(const TimeToError& time) {
  if (!time.reached()) return "-";
  return time.iterations > 0 ? fmt::format("{:.1f} (#{})", time.ms, time.iterations)
                             : fmt::format("{:.1f}", time.ms);
}

}  // namespace taut::app
