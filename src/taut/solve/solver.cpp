#include "taut/solve/solver.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include "taut/base/error.h"
#include "taut/constraint/reduction.h"
#include "taut/linalg/sparse_cholesky.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/auto_solver.h"
#include "taut/solve/block_direct.h"
#include "taut/solve/core_fast.h"
#include "taut/solve/core_pcg.h"
#include "taut/solve/direct.h"
#include "taut/solve/eq10.h"
#include "taut/solve/mpcg.h"
#include "taut/solve/ppcg.h"
#include "taut/solve/upcg.h"

namespace taut {

namespace {

template <class Solver, class... Choice>
SolverFactory made(Choice... choice) {
  return [=](const SolverOptions& options) { return std::make_unique<Solver>(options, choice...); };
}
template <class Solver>
SolverFactory made_with(const PreconditionerChoice& choice) {
  return
      [&choice](const SolverOptions& options) { return std::make_unique<Solver>(options, choice); };
}

struct Entry {
  const char* name;
  SolverFactory make;   // empty: the backend's library registers it
  const char* backend;  // the Cholesky it cannot do without, or null
};

// The list: one line a solver.
const std::vector<Entry>& entries() {
  static const std::vector<Entry> list = {
      {"mpcg", made_with<Mpcg>(preconditioner::diagonal), nullptr},
      {"mpcg:diagonal", made_with<Mpcg>(preconditioner::diagonal), nullptr},
      {"mpcg:block_diagonal", made_with<Mpcg>(preconditioner::block_diagonal), nullptr},
      {"mpcg:projected_block_diagonal", made_with<Mpcg>(preconditioner::projected_block_diagonal),
       nullptr},
      {"mpcg:ic0", made_with<Mpcg>(preconditioner::ic0), nullptr},
      {"mpcg:ic0_core", made_with<Mpcg>(preconditioner::ic0_core), nullptr},
      {"mpcg:ssor", made_with<Mpcg>(preconditioner::ssor), nullptr},
      {"upcg", made_with<Upcg>(preconditioner::diagonal), nullptr},
      {"upcg:diagonal", made_with<Upcg>(preconditioner::diagonal), nullptr},
      {"upcg:block_diagonal", made_with<Upcg>(preconditioner::block_diagonal), nullptr},
      {"upcg:reduced_diagonal", made_with<Upcg>(preconditioner::reduced_diagonal), nullptr},
      {"upcg:projected_block_diagonal", made_with<Upcg>(preconditioner::projected_block_diagonal),
       nullptr},
      {"upcg:ic0", made_with<Upcg>(preconditioner::ic0), nullptr},
      {"upcg:ic0_core", made_with<Upcg>(preconditioner::ic0_core), nullptr},
      {"upcg:ssor", made_with<Upcg>(preconditioner::ssor), nullptr},
      {"upcg:amg", made_with<Upcg>(preconditioner::amg), nullptr},
      {"ppcg", made_with<Ppcg>(preconditioner::projected_block_diagonal), nullptr},
      {"ppcg:block_diagonal", made_with<Ppcg>(preconditioner::projected_block_diagonal), nullptr},
      {"ppcg:ic0", made_with<Ppcg>(preconditioner::ic0), nullptr},
      {"ppcg:ic0_core", made_with<Ppcg>(preconditioner::ic0_core), nullptr},
      {"ppcg:ssor", made_with<Ppcg>(preconditioner::ssor), nullptr},
      {"ppcg:amg", made_with<Ppcg>(preconditioner::amg), nullptr},
      {"eq10", made<Eq10>(Eq10Preconditioner::block_diagonal), nullptr},
      {"eq10:block_diagonal", made<Eq10>(Eq10Preconditioner::block_diagonal), nullptr},
      {"eq10:ilu0", made<Eq10>(Eq10Preconditioner::ilu0), nullptr},
      {"cholmod", made<Direct>("cholmod"), "cholmod"},
      {"cholmod_reused_analysis", made<Direct>("cholmod", AnalysisUse::kept), "cholmod"},
      {"pardiso", made<Direct>("pardiso"), "pardiso"},
      {"pardiso_cgs", nullptr, "pardiso"},
      {"eigen_ldlt", made<Direct>("eigen"), nullptr},
      {"block_cholesky", made<BlockDirect>(), nullptr},
      {"core_fast", made<CoreFast>(), nullptr},
      {"core_pcg", made<CorePcg>(""), nullptr},
      {"core_pcg:cholmod", made<CorePcg>("cholmod"), "cholmod"},
      {"core_pcg:eigen", made<CorePcg>("eigen"), nullptr},
      {"core_pcg:block", made<CorePcg>("block"), nullptr},
      {"auto", made<AutoSolver>(), nullptr},
      {"core_pcg:pardiso", made<CorePcg>("pardiso"), "pardiso"},
  };
  return list;
}

// What a direct method in double precision may leave where the matrix is regular: stiff cloth at
// large steps leaves 1e-6.
constexpr double worst_direct_residual = 1e-2;

std::map<std::string, SolverFactory>& registered() {
  static std::map<std::string, SolverFactory> factories;
  return factories;
}

const Entry* find_entry(const std::string& name) {
  for (const Entry& entry : entries())
    if (name == entry.name) return &entry;
  return nullptr;
}

bool available(const Entry& entry) {
  return entry.make ? !entry.backend || make_cholesky(entry.backend)
                    : registered().contains(entry.name);
}

std::string how_to_get(const std::string& backend) {
  return backend == "pardiso" ? "type './taut setup pardiso' (or install oneMKL and build with "
                                "-DTAUT_WITH_PARDISO=ON)"
                              : "build with -DTAUT_WITH_CHOLMOD=ON";
}

}  // namespace

std::unique_ptr<ConstrainedSolver> make_solver(const SolverOptions& options) {
  const std::vector<std::string> known = solver_names();
  const Entry* entry = find_entry(options.name);
  if (!entry) {
    const std::string near = nearest_name(options.name, known);
    throw InputError(fmt::format("unknown solver '{}'{}; the solvers are: {}", options.name,
                                 near.empty() ? "" : fmt::format(" (did you mean '{}'?)", near),
                                 fmt::join(known, ", ")));
  }
  if (!available(*entry))
    throw InputError(fmt::format(
        "solver '{}' needs the {} backend, which is not built into this program; {}, or use one "
        "of: {}",
        options.name, entry->backend, how_to_get(entry->backend), fmt::join(known, ", ")));
  return entry->make ? entry->make(options) : registered().at(entry->name)(options);
}

void register_solver(const std::string& name, SolverFactory factory) {
  assert(find_entry(name) && !find_entry(name)->make);
  registered()[name] = std::move(factory);
}

std::vector<std::string> solver_names() {
  std::vector<std::string> names;
  for (const Entry& entry : entries())
    if (available(entry)) names.emplace_back(entry.name);
  return names;
}

bool is_solver_name(const std::string& name) { return find_entry(name) != nullptr; }

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
    summary = solve(unguessed, x);
    summary.remark += summary.remark.empty() ? "" : "; ";
    summary.remark += "the initial guess held NaN or infinity and was left out";
    return summary;
  }
  run(system, x, summary);
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
