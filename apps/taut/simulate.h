#pragma once
// What `run` and `resume` share: run with progress and interruption, draw the contact sheet, say
// what came out and where it is.

#include <string>

#include "progress.h"
#include "taut/results/run.h"

namespace taut::app {

struct SimulateOptions {
  ProgressStyle style = ProgressStyle::automatic;
  bool picture = true;        // draw the contact sheet at the end
  std::string export_format;  // of an export while it runs (live_export.h); empty: none
};

// Returns the exit code.
int simulate(SceneSimulation& simulation, const ResultsFolder& results,
             const SimulateOptions& options, int first_frame);

}  // namespace taut::app
