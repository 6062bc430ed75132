#include <fmt/format.h>

#include "simulate.h"
#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/results/result_frames.h"
#include "taut/scene/scene_file.h"
#include "verbs.h"

namespace taut::app {

namespace {

struct ResumeArguments {
  std::string folder;
  int threads = 0, frames = 0;
  SimulateOptions options;
};

int resume(const ResumeArguments& arguments) {
  if (arguments.threads > 0) set_thread_count(arguments.threads);
  const ResultsFolder results(arguments.folder);
  results.refuse_running();
  std::vector<std::string> settings;
  if (arguments.frames > 0) settings.push_back(fmt::format("time.frames={}", arguments.frames));
  SceneSimulation simulation(read_scene(results.scene_file(), settings));
  const CheckpointPlace place = results.read_checkpoint(simulation);
  const int frames = simulation.scene().time.frames;
  if (place.frame > frames)
    throw InputError(
        {arguments.folder},
        fmt::format(
            "has {} frames already, more than the {} it shall have; give --frames {} or more",
            place.frame, frames, place.frame));
  if (place.other_length) results.change_length(simulation);
  const bool says = arguments.options.style == ProgressStyle::automatic;
  if (place.frame == frames && arguments.options.export_format.empty() &&
      ResultFrames(arguments.folder).run_has_finished()) {
    if (says)
      fmt::print(stderr,
                 "{0} has all its {1} frames; to extend it: taut resume {0} --frames N, with N "
                 "above {1}\n",
                 arguments.folder, frames);
    return 0;
  }
  if (says)
    fmt::print(stderr, "going on after frame {} (step {})\n", place.frame, simulation.steps_done());
  return simulate(simulation, results, arguments.options, place.frame);
}

}  // namespace

void add_resume_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb =
      app.add_subcommand("resume", "Go on with an interrupted simulation, to the same bits");
  auto arguments = std::make_shared<ResumeArguments>();
  auto quiet = std::make_shared<bool>(false);
  verb->add_option("DIR", arguments->folder, "Results folder of the interrupted run")->required();
  verb->add_option("--frames", arguments->frames,
                   "Go on until there are this many frames after the first; extends a run that has "
                   "finished, too")
      ->check(between(1, 1'000'000));
  verb->add_option("--threads", arguments->threads, "Threads to use (default: all processors)")
      ->check(between(1, 1024));
  verb->add_flag("--quiet", *quiet, "No progress and no table");
  auto json_lines = std::make_shared<bool>(false);
  verb->add_flag("--json-lines", *json_lines, "Progress as one JSON object a step on stdout");
  auto no_picture = std::make_shared<bool>(false);
  verb->add_flag("--no-picture", *no_picture, "Draw no contact sheet at the end");
  verb->add_option("--export", arguments->options.export_format,
                   "Export all frames, those that are there first, into DIR/FORMAT, as `taut "
                   "export` does afterwards")
      ->type_name("FORMAT")
      ->check(CLI::IsMember(export_format_names()));
  verb->footer("Example: taut resume out/ball\nExample: taut resume out/ball --frames 160");
  verb->callback([=, &exit_code] {
    arguments->options.style = *json_lines ? ProgressStyle::json_lines
                               : *quiet    ? ProgressStyle::quiet
                                           : ProgressStyle::automatic;
    arguments->options.picture = !*no_picture;
    exit_code = resume(*arguments);
  });
}

}  // namespace taut::app
