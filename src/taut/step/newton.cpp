#include "taut/step/newton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

// 1/4096 of a Newton step gains nothing that halving the time step does not gain sooner.
constexpr int most_halvings = 12;
constexpr double steepest_uphill = 0.5;

void add_solve(SolveSummary& sum, const SolveSummary& solve) {
  SolveSummary total = solve;
  total.iterations = std::max(sum.iterations, solve.iterations);
  total.bound_iterations = std::max(sum.bound_iterations, solve.bound_iterations);
  total.reduce_ms += sum.reduce_ms;
  total.order_ms += sum.order_ms;
  total.factor_ms += sum.factor_ms;
  total.solve_ms += sum.solve_ms;
  total.relative_residual = std::max(sum.relative_residual, solve.relative_residual);
  total.memory_bytes = std::max(sum.memory_bytes, solve.memory_bytes);
  sum = std::move(total);
}

}  // namespace

NewtonSummary newton(const NewtonProblem& problem, const NewtonOptions& options, double scale,
                     const SolveSummary& linear, std::vector<Vec3>& u) {
  NewtonSummary summary;
  summary.linear = linear;
  double norm = problem.relinearise(u);
  std::vector<Vec3> before, way(u.size());
  const auto converged = [&] { return norm <= options.tolerance * scale; };
  while (!converged() && summary.iterations < options.max_iterations) {
    before = u;
    add_solve(summary.linear, problem.solve(u));
    ++summary.iterations;
    if (!summary.linear.status.ok()) break;
    for (std::size_t i = 0; i < u.size(); ++i) way[i] = u[i] - before[i];
    const double downhill = problem.slope(way);
    norm = problem.relinearise(u);
    for (int halving = 0;
         !(problem.slope(way) >= -steepest_uphill * std::abs(downhill)) && halving < most_halvings;
         ++halving) {
      for (std::size_t i = 0; i < u.size(); ++i) u[i] = 0.5 * (before[i] + u[i]);
      norm = problem.relinearise(u);
      ++summary.halvings;
    }
  }
  summary.residual = scale > 0.0 ? norm / scale : 0.0;
  summary.status = summary.linear.status;
  if (!summary.status.ok()) return summary;
  if (!std::isfinite(norm)) {
    summary.status = {Outcome::not_finite, "Newton's method: the residual is not finite"};
  } else if (!converged()) {
    summary.status = {Outcome::max_iterations,
                      fmt::format("Newton's method stopped after {} of {} iterations at a residual "
                                  "of {:.2g}, wanted {:.2g}",
                                  summary.iterations, options.max_iterations, summary.residual,
                                  options.tolerance)};
  }
  return summary;
}

}  // namespace taut
