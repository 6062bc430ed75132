#pragma once
// meta.json of a dump: what the matrices do not say. Keys: docs/dump.md.

#include <string>

#include "taut/sim/simulation.h"

namespace taut {

// As JSON text; to be called from Simulation::on_solved.
std::string dump_meta(Simulation& simulation, const SolveSummary& summary);

}  // namespace taut
