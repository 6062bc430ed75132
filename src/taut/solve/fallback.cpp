#include "taut/solve/fallback.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace taut {

std::span<const char* const> fallback_chain() {
  static constexpr const char* names[] = {"block_cholesky", "eigen_ldlt"};
  return names;
}

FallbackChain::FallbackChain(SolverOptions options, std::span<const char* const> names)
    : options_(std::move(options)) {
  const std::vector<std::string> known = solver_names();
  for (const char* name : names)
    if (std::ranges::count(known, name) > 0) names_.emplace_back(name);
  solvers_.resize(names_.size());
}

SolveSummary FallbackChain::solve(ConstrainedSolver& first, const LinearSystem& system,
                                  std::span<double> x) {
  return solve(first, [&](ConstrainedSolver& solver) { return solver.solve(system, x); });
}

SolveSummary FallbackChain::solve(
    ConstrainedSolver& first, const std::function<SolveSummary(ConstrainedSolver&)>& solve_with) {
  SolveSummary summary = solve_with(first);
  std::string reasons = fmt::format("{}: {}", summary.solver, summary.status.message);
  int fallbacks = 0;
  for (std::size_t k = 0; k < names_.size() && !summary.status.ok(); ++k) {
    // `auto` may have ended with this one.
    if (summary.method == names_[k]) continue;
    if (!solvers_[k]) {
      SolverOptions options = options_;
      options.name = names_[k];
      solvers_[k] = make_solver(options);
    }
    summary = solve_with(*solvers_[k]);
    summary.fallbacks += ++fallbacks;
    reasons += fmt::format("; then {}: {}", summary.solver, summary.status.message);
  }
  if (!summary.status.ok() && fallbacks > 0) summary.status.message = reasons;
  return summary;
}

}  // namespace taut
