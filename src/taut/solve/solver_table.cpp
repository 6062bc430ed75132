#include "taut/solve/solver_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

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

struct Method {
  const char* name;
  PcgMethod method;
  SolverFactory (*made_with)(PreconditionerChoice);

  bool takes(const NamedPreconditioner& preconditioner) const {
    return std::ranges::count(preconditioner.methods, method) > 0;
  }
  SolverEntry with(const NamedPreconditioner& preconditioner) const {
    return {fmt::format("{}:{}", name, preconditioner.name),
            made_with(preconditioner.choice),
            {.needs_core = preconditioner.choice.source == PreconditionerSource::core}};
  }
};
constexpr Method methods[] = {{"mpcg", PcgMethod::mpcg, made<Mpcg>},
                              {"upcg", PcgMethod::upcg, made<Upcg>},
                              {"ppcg", PcgMethod::ppcg, made<Ppcg>}};

// All others: one line a solver.
std::vector<SolverEntry> other_solvers() {
  const SolverTraits core_pcg{.needs_core = true, .needs_rho = true, .bounds_iterations = true};
  const auto direct = [](const char* backend, bool keeps_analysis = false) {
    return SolverTraits{
        .is_direct = true, .keeps_analysis = keeps_analysis, .needs_backend = backend};
  };
  const auto core_pcg_on = [&](const char* backend) {
    SolverTraits traits = core_pcg;
    traits.needs_backend = backend;
    return traits;
  };
  SolverTraits core_fast = core_pcg;
  core_fast.proves_error = core_fast.keeps_analysis = true;
  const SolverTraits chosen{.needs_core = true,
                            .needs_rho = true,
                            .keeps_analysis = true,
                            .shows_iterates = false,
                            .chooses_core = true};
  return {
      {"eq10", made<Eq10>(Eq10Preconditioner::block_diagonal)},
      {"eq10:block_diagonal", made<Eq10>(Eq10Preconditioner::block_diagonal)},
      {"eq10:ilu0", made<Eq10>(Eq10Preconditioner::ilu0)},
      {"cholmod", made<Direct>("cholmod"), direct("cholmod")},
      {"cholmod_reused_analysis", made<Direct>("cholmod", AnalysisUse::kept),
       direct("cholmod", true)},
      {"pardiso", made<Direct>("pardiso"), direct("pardiso")},
      {"pardiso_cgs", nullptr, {.shows_iterates = false, .needs_backend = "pardiso"}},
      {"eigen_ldlt", made<Direct>("eigen"), direct("")},
      {"block_cholesky", made<BlockDirect>(), direct("", true)},
      {"core_fast", made<CoreFast>(), core_fast},
      {"core_pcg", made<CorePcg>(""), core_pcg},
      {"core_pcg:cholmod", made<CorePcg>("cholmod"), core_pcg_on("cholmod")},
      {"core_pcg:eigen", made<CorePcg>("eigen"), core_pcg},
      {"core_pcg:block", made<CorePcg>("block"), core_pcg},
      {"auto", made<AutoSolver>(), chosen},
      {"core_pcg:pardiso", made<CorePcg>("pardiso"), core_pcg_on("pardiso")},
  };
}

}  // namespace

std::vector<SolverEntry> preconditioned_solvers(const NamedPreconditioner& preconditioner) {
  std::vector<SolverEntry> solvers;
  for (const Method& method : methods)
    if (method.takes(preconditioner)) solvers.push_back(method.with(preconditioner));
  return solvers;
}

std::vector<SolverEntry> builtin_solvers() {
  std::vector<SolverEntry> solvers;
  for (const Method& method : methods) {
    bool first = true;
    for (const NamedPreconditioner& preconditioner : builtin_preconditioners()) {
      if (!method.takes(preconditioner)) continue;
      SolverEntry solver = method.with(preconditioner);
      if (std::exchange(first, false)) solvers.push_back({method.name, solver.make, solver.traits});
      solvers.push_back(std::move(solver));
    }
  }
  for (SolverEntry& solver : other_solvers()) solvers.push_back(std::move(solver));
  return solvers;
}

}  // namespace taut
