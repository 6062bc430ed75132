#include <fmt/format.h>

#include "simulate.h"
#include "taut/base/parallel.h"
#include "taut/scene/scene_file.h"
#include "verbs.h"

namespace taut::app {

namespace {

struct RunArguments {
  std::string scene, out, solver, export_format;
  int frames = 0, threads = 0;
  std::vector<std::string> settings;
  bool quiet = false, json_lines = false, no_picture = false, untangle = false;
};

int run_scene(const RunArguments& arguments) {
  if (arguments.threads > 0) set_thread_count(arguments.threads);
  std::vector<std::string> settings = arguments.settings;
  if (arguments.frames > 0) settings.push_back(fmt::format("time.frames={}", arguments.frames));
  if (!arguments.solver.empty()) settings.push_back("solver.name=" + arguments.solver);
  if (arguments.untangle) settings.push_back("contact.untangle=true");
  Scene scene = read_scene(arguments.scene, settings);
  const ProgressStyle style = arguments.json_lines ? ProgressStyle::json_lines
                              : arguments.quiet    ? ProgressStyle::quiet
                                                   : ProgressStyle::automatic;
  if (style == ProgressStyle::automatic)
    for (const std::string& doubt : doubtful(scene)) fmt::print(stderr, "note: {}\n", doubt);
  const ResultsFolder results(arguments.out.empty()
                                  ? std::filesystem::path("out") /
                                        std::filesystem::path(arguments.scene).stem()
                                  : std::filesystem::path(arguments.out));
  SceneSimulation simulation(std::move(scene));
  for (const std::string& note : results.start(simulation))
    if (style != ProgressStyle::quiet) fmt::print(stderr, "note: {}\n", note);
  return simulate(simulation, results, {style, !arguments.no_picture, arguments.export_format}, 0);
}

}  // namespace

void add_run_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand("run", "Simulate a scene");
  auto arguments = std::make_shared<RunArguments>();
  verb->add_option("SCENE", arguments->scene, "Scene file (TOML)")->required();
  verb->add_option("--out", arguments->out, "Folder for the results (default: out/SCENE)");
  verb->add_option(
          "--frames", arguments->frames,
          "Frames to write after the first, instead of the scene's time.frames: fewer or more")
      ->check(between(1, 1'000'000));
  verb->add_option("--threads", arguments->threads,
                   "Threads to use (default: all processors); the results do not depend on it")
      ->check(between(1, 1024));
  verb->add_option("--solver", arguments->solver, "Linear solver, as solver.name in the scene")
      ->check(solver_name());
  verb->add_option(
          "--set", arguments->settings,
          "Change a key of the scene: key=value, e.g. cloth.k_stretch=600; may be repeated")
      ->take_all()
      ->type_name("KEY=VALUE");
  verb->add_flag("--untangle", arguments->untangle,
                 "Draw cloth that intersects at the start, or is inside a solid, apart before the "
                 "first step; frame 0 shows it then");
  verb->add_flag("--quiet", arguments->quiet, "No progress and no table");
  verb->add_flag("--json-lines", arguments->json_lines,
                 "Progress as one JSON object a step on stdout");
  verb->add_flag("--no-picture", arguments->no_picture, "Draw no contact sheet at the end");
  verb->add_option(
          "--export", arguments->export_format,
          "Export the frames as they come into OUT/FORMAT, as `taut export` does afterwards")
      ->type_name("FORMAT")
      ->check(CLI::IsMember(export_format_names()));
  verb->footer(
      "Example: taut run scenes/ball.toml --set cloth.grid.nodes=[41,41] --out out/small\n"
      "Ctrl-C stops after the current step with everything so far valid; `taut resume DIR` goes "
      "on.");
  verb->callback([arguments, &exit_code] { exit_code = run_scene(*arguments); });
}

}  // namespace taut::app
