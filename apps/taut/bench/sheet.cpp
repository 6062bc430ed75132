// What flatness and scale have in common: which methods, which sheet, which state.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/benches.h"
#include "taut/base/error.h"
#include "taut/solve/solver.h"

namespace taut::app {

std::vector<std::string> methods_of(const BenchOptions& options) {
  // throws for one that there is not
  for (const std::string& name : options.methods) make_solver({.name = name});
  if (!options.methods.empty()) return options.methods;
  const std::vector<std::string> known = solver_names();
  std::vector<std::string> methods;
  for (const char* name :
       {"cholmod", "cholmod_reused_analysis", "pardiso", "block_cholesky", "mpcg:block_diagonal",
        "upcg:ic0_core", "upcg:ic0", "upcg:amg", "core_pcg", "core_fast", "auto"})
    if (std::ranges::count(known, name)) methods.emplace_back(name);
  return methods;
}

int side_of(int nodes) {
  const int side = static_cast<int>(std::lround(std::sqrt(nodes)));
  if (side < 2 || side * side != nodes)
    throw InputError(
        fmt::format("--nodes {}: the sheet is a square grid, so its nodes are a square number of "
                    "at least 4, as 6561",
                    nodes));
  return side;
}

void run_into_contact(SceneSimulation& simulation, int more) {
  constexpr int most_steps = 1000;
  StepReport record;
  const auto advance = [&] {
    if (const Status status = simulation.step(record); !status.ok())
      throw InputError(status.message);
  };
  do advance();
  while (record.contacts == 0 && simulation.steps_done() < most_steps);
  if (record.contacts == 0)
    throw InputError(fmt::format("the scene '{}' came to no contact in {} steps",
                                 simulation.scene().title, most_steps));
  for (int step = 0; step < more; ++step) advance();
}

}  // namespace taut::app
