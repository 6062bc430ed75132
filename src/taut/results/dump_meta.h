#pragma once
// meta.json of a dump: what the matrices do not say. Keys: docs/dump.md.

#include <string>

#include "taut/scene/scene_simulation.h"
#include "taut/solve/linear_system.h"

namespace taut {

// As JSON text; to be called from SceneSimulation::on_solved.
std::string dump_meta(SceneSimulation& simulation, const SolveSummary& summary);

}  // namespace taut
