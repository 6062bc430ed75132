#include "taut/solve/solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "taut/base/error.h"
#include "taut/linalg/node_basis.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

namespace {

// What a direct method in double precision may leave where the matrix is regular: stiff cloth at
// large steps leaves 1e-6.
constexpr double worst_direct_residual = 1e-2;

}  // namespace

void ConstrainedSolver::restore_memory(std::span<const double> memory) {
  if (!memory.empty())
    throw InputError(
        fmt::format("the stored memory of a solver does not belong to '{}'", options_.name));
}

int ConstrainedSolver::iteration_limit(Index unknowns) const {
  if (options_.max_iterations > 0) return options_.max_iterations;
  return static_cast<int>(
      std::min<std::int64_t>(1'000'000, std::max<std::int64_t>(1000, 10 * std::int64_t{unknowns})));
}

SolveSummary ConstrainedSolver::solve(const LinearSystem& system, std::span<double> x) {
  SolveSummary summary = checked(&ConstrainedSolver::run, system, x);
  has_solved_ = summary.status.ok();
  return summary;
}

SolveSummary ConstrainedSolver::solve_again(const LinearSystem& system, std::span<double> x) {
  if (!has_solved_) return solve(system, x);
  SolveSummary summary = checked(&ConstrainedSolver::run_again, system, x);
  has_solved_ = summary.status.ok();
  return summary;
}

SolveSummary ConstrainedSolver::checked(Run method, const LinearSystem& system,
                                        std::span<double> x) {
  assert(system.matrix && system.rhs.size() == x.size() &&
         static_cast<Index>(x.size()) == system.matrix->dofs());
  assert(!system.constraints || system.z.size() == x.size());
  SolveSummary summary;
  summary.solver = summary.method = options_.name;
  if (!all_finite(system.rhs) || !all_finite(system.z)) {
    summary.status = {Outcome::not_finite, "the right-hand side holds NaN or infinity"};
    initial_guess(system, x);
    return summary;
  }
  if (!all_finite(system.guess)) {
    LinearSystem unguessed = system;
    unguessed.guess = {}, unguessed.guess_is_iterate = false;
    summary = checked(method, unguessed, x);
    summary.remark += summary.remark.empty() ? "" : "; ";
    summary.remark += "the initial guess held NaN or infinity and was left out";
    return summary;
  }
  (this->*method)(system, x, summary);
  summary.relative_residual = relative_residual(system, x);
  if (!std::isfinite(summary.relative_residual) && summary.status.ok())
    summary.status = {Outcome::not_finite, "the solution holds NaN or infinity"};
  if (summary.status.ok() && is_direct() && summary.relative_residual > worst_direct_residual)
    summary.status = {Outcome::breakdown,
                      fmt::format("the factorisation leaves a relative residual of {:.2g}: the "
                                  "matrix is singular, or too "
                                  "ill-conditioned for {} precision",
                                  summary.relative_residual, summary.precision)};
  if (!std::isfinite(summary.relative_residual)) initial_guess(system, x);
  return summary;
}

void initial_guess(const LinearSystem& system, std::span<double> x) {
  system.guess.empty() ? set_zero(x) : copy(system.guess, x);
  if (!system.constraints) return;
  for_each_projected(system.constraints->ndofs(), [&](Index i) {
    Eigen::Map<Vec3> node(&x[3 * static_cast<std::size_t>(i)]);
    const Vec3 z = Eigen::Map<const Vec3>(&system.z[3 * static_cast<std::size_t>(i)]);
    node = system.constraints->free_part(i, node) + system.constraints->constrained_part(i, z);
  });
}

}  // namespace taut
