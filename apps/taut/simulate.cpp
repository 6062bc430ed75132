#include "simulate.h"

#include <fmt/format.h>

#include "interrupt.h"
#include "live_export.h"

namespace taut::app {

namespace {

void print_summary(const RunSummary& s, const SceneSimulation& simulation,
                   const ResultsFolder& results, bool picture) {
  const Scene& scene = simulation.scene();
  fmt::print("\n");
  if (!scene.title.empty()) fmt::print("{}\n\n", scene.title);
  const auto row = [](const char* name, const std::string& value) {
    fmt::print("  {:<22}{}\n", name, value);
  };
  row("nodes", fmt::format("{}", s.nodes));
  row("solver", fmt::format("{}, tolerance {:g}", scene.solver.name, scene.solver.tolerance));
  row("steps", fmt::format("{} of {:g} ms ({} frames, {:.3f} s simulated in {:.1f} s)", s.steps,
                           1000.0 * scene.time.step, s.frames, s.simulated_s, s.wall_s));
  row("time a step",
      fmt::format("{:.1f} ms: assembly {:.1f}, solver {:.1f}, contact {:.1f}", s.mean_step_ms,
                  s.mean_assemble_ms, s.mean_solver_ms, s.mean_contact_ms));
  row("iterations",
      fmt::format("{:.1f} on average, {} at most", s.mean_iterations, s.max_iterations));
  row("largest stretch", fmt::format("{:.1f} %", 100.0 * s.max_stretch));
  if (s.overshoots.steps > 0)
    row("overshoot",
        fmt::format(
            "up to {:.1f} % of a spring's length in {} steps, although they were halved {} times",
            100.0 * s.overshoots.largest, s.overshoots.steps, scene.time.max_halvings));
  if (s.deepest_m > 0.0)
    row("deepest in a solid",
        fmt::format("{:.3g} mm before it was moved out", 1000.0 * s.deepest_m));
  if (s.fallbacks > 0)
    row("fall-backs",
        fmt::format(
            "{} solves were begun again, with a factor in double precision or by a direct method",
            s.fallbacks));
  row("peak memory", fmt::format("{:.0f} MB", s.peak_memory_MB));
  fmt::print("\n");
  if (picture) row("picture", results.contact_sheet_file().string());
  row("frames", (results.folder() / "frames").string());
  row("step by step", results.stats_file().string());
  row("summary", results.summary_file().string());
  fmt::print(
      "\n  taut view {0}                  shows it in the browser\n  taut export {0} --format usd  "
      " turns the frames into files for other "
      "programs\n",
      results.folder().string());
}

}  // namespace

int simulate(SceneSimulation& simulation, const ResultsFolder& results,
             const SimulateOptions& options, int first_frame) {
  RunSummary summary;
  int exported = -1;  // 0: failed
  {
    const auto progress = make_progress(options.style, simulation.scene());
    std::unique_ptr<LiveExport> exporting;
    if (!options.export_format.empty())
      exporting = std::make_unique<LiveExport>(results, options.export_format, *progress);
    summary =
        run(simulation, results, exporting ? *exporting : *progress, interrupt_flag(), first_frame);
    if (exporting) exported = exporting->finish() ? 1 : 0;
    if (options.style == ProgressStyle::json_lines)
      for (const std::string& warning : summary.warnings)
        progress->on_message("warning: " + warning);
  }
  const bool draws = options.picture &&
                     (summary.steps > 0 || !std::filesystem::exists(results.contact_sheet_file()));
  if (draws) draw_contact_sheet(simulation, results);
  if (options.style == ProgressStyle::automatic)
    print_summary(summary, simulation, results, options.picture);
  if (options.style != ProgressStyle::json_lines)
    for (const std::string& warning : summary.warnings)
      fmt::print(stderr, "taut: warning: {}\n", warning);
  switch (summary.end) {
    case RunEnd::finished:
      return exported == 0 ? 1 : 0;
    case RunEnd::interrupted:
      fmt::print(stderr, "\ninterrupted after {} frames; go on with: taut resume {}\n",
                 summary.frames, results.folder().string());
      return 1;
    case RunEnd::failed:
      fmt::print(stderr, "taut: {}\nEverything up to there is in {}\n", summary.message,
                 results.folder().string());
      return 1;
  }
  return 1;
}

}  // namespace taut::app
