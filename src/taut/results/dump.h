#pragma once
// `taut dump`: the linear system of one step as files that any tool reads. docs/dump.md names each
// file, its shape and units, and how they make up A and b.
//
//   A, A_core, K_stretch, K_shear, K_bend, D_external, S, U     Matrix Market, sparse
//   M, b, z, x, v, f, dv, x_prev, v_prev, guess, friction       Matrix Market, 3N x 1
//   springs.csv                                                 what the elements are
//   meta.json   step size, integrator, solver and what it reported; written last: a dump without it
//               is not complete

#include <filesystem>
#include <functional>

#include "taut/scene/scene_simulation.h"
#include "taut/solve/linear_system.h"

namespace taut {

// Makes the folder ready: files of an earlier dump are removed. Throws InputError when it holds
// anything else.
void prepare_dump(const std::filesystem::path& folder);

// Writes the system that `simulation` has just solved: to be called from
// SceneSimulation::on_solved. Step numbers count from 1.
void write_dump(const std::filesystem::path& folder, SceneSimulation& simulation,
                const SolveSummary& summary);

struct DumpOutcome {
  Status status;  // not ok: an earlier step, or this one, could not be solved; nothing was written
  SolveSummary summary;
};

// Runs the scene to step `step` (from 1) and writes the system of its last contact pass. `on_step`
// is told about every step and may be empty.
DumpOutcome dump_step(SceneSimulation& simulation, int step, const std::filesystem::path& folder,
                      const std::function<void(const StepReport&)>& on_step = {});

}  // namespace taut
