#pragma once
// Runs a scene into a results folder: frames, stats, checkpoints, summary, contact sheet; and goes
// on after an interruption.

#include <atomic>

#include "taut/results/results.h"

namespace taut {

// Told what happens, for progress displays. Called from the running thread.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void on_step(const StepReport&, int /*steps_total*/) {}
  virtual void on_frame(int /*frame*/, int /*frames_total*/) {}
  // Something the user should know but that does not stop the run: a fall-back, say.
  virtual void on_message(const std::string&) {}
};

enum class RunEnd { finished, interrupted, failed };
const char* name_of(RunEnd end);

// Steps in which a spring still ended longer than foreseen (TimeOptions::overshoot_limit) after the
// last halving. A few per cent too much hardly show; a step in which springs also stretch by `torn`
// or more no longer tells what cloth would do, and the user is warned.
struct AcceptedOvershoots {
  static constexpr double torn = 0.3;  // share of a rest length
  int steps = 0;
  int torn_steps = 0, first_torn = 0;
  double largest = 0.0;  // share of a rest length
};

struct RunSummary {
  RunEnd end = RunEnd::finished;
  std::string message;  // why it failed
  int steps = 0, frames = 0;
  double simulated_s = 0.0, wall_s = 0.0;
  double mean_step_ms = 0.0, mean_iterations = 0.0, mean_assemble_ms = 0.0, mean_solver_ms = 0.0,
         mean_contact_ms = 0.0;
  int max_iterations = 0;
  double max_stretch = 0.0;
  WorstStretch worst_stretch;  // where and when that was
  int worst_step = 0;
  double worst_time = 0.0;  // s
  AcceptedOvershoots overshoots;
  // of results that should not be trusted, whatever the end: sentences for the user
  std::vector<std::string> warnings;
  double deepest_m = 0.0;
  int fallbacks = 0;
  Index nodes = 0;
  double peak_memory_MB = 0.0;
};

// Runs all frames of the simulation's scene from where it stands (frame 0, or `first_frame` after
// read_checkpoint) until done, failed, or `interrupt` becomes true. Whatever happens, the folder is
// valid up to the last written frame, and the summary and the contact sheet are written.
RunSummary run(SceneSimulation& simulation, const ResultsFolder& results, RunObserver& observer,
               const std::atomic<bool>& interrupt, int first_frame = 0);

// After a failed step: writes the state before it into `last_good/` of the folder, all surfaces as
// surface.obj, and where cloth could not be kept apart a picture of the place, place.png. Returns
// the folder.
std::filesystem::path save_last_good(const SceneSimulation& simulation,
                                     const ResultsFolder& results);

// Draws some frames of a results folder side by side. Throws InputError when there are none.
void draw_contact_sheet(const SceneSimulation& simulation, const ResultsFolder& results);

}  // namespace taut
