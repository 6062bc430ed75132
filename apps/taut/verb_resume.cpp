#include <fmt/format.h>

#include "simulate.h"
#include "taut/base/parallel.h"
#include "taut/scene/scene_file.h"
#include "verbs.h"

namespace taut::app {

namespace {

int resume(const std::string& folder, int threads, ProgressStyle style, bool picture, const std::string& export_format) {
  if (threads > 0) set_thread_count(threads);
  const ResultsFolder results(folder);
  Simulation simulation(read_scene(results.scene_file()));
  const int frame = results.read_checkpoint(simulation);
  if (style == ProgressStyle::automatic) fmt::print(stderr, "going on after frame {} (step {})\n", frame, simulation.steps_done());
  return simulate(simulation, results, {style, picture, export_format}, frame);
}

}  // namespace

void add_resume_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand("resume", "Go on with an interrupted simulation, to the same bits");
  auto folder = std::make_shared<std::string>();
  auto threads = std::make_shared<int>(0);
  auto quiet = std::make_shared<bool>(false);
  verb->add_option("DIR", *folder, "Results folder of the interrupted run")->required();
  verb->add_option("--threads", *threads, "Threads to use (default: all processors)")->check(CLI::Range(1, 1024));
  verb->add_flag("--quiet", *quiet, "No progress and no table");
  auto json_lines = std::make_shared<bool>(false);
  verb->add_flag("--json-lines", *json_lines, "Progress as one JSON object a step on stdout");
  auto no_picture = std::make_shared<bool>(false);
  verb->add_flag("--no-picture", *no_picture, "Draw no contact sheet at the end");
  auto export_format = std::make_shared<std::string>();
  verb->add_option("--export", *export_format,
                   "Export all frames, those that are there first, into DIR/FORMAT, as `taut export` does afterwards")
      ->type_name("FORMAT")
      ->check(CLI::IsMember(export_format_names()));
  verb->footer("Example: taut resume out/ball");
  verb->callback([=, &exit_code] {
    const ProgressStyle style = *json_lines ? ProgressStyle::json_lines : *quiet ? ProgressStyle::quiet : ProgressStyle::automatic;
    exit_code = resume(*folder, *threads, style, !*no_picture, *export_format);
  });
}

}  // namespace taut::app
