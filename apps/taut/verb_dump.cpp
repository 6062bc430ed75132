#include <fmt/format.h>

#include "progress.h"
#include "taut/base/parallel.h"
#include "taut/constraint/constraint_set.h"
#include "taut/results/dump.h"
#include "taut/scene/scene_file.h"
#include "taut/sim/cloth_model.h"
#include "verbs.h"

namespace taut::app {

namespace {

struct DumpArguments {
  std::string scene, out, solver;
  int step = 1, threads = 0;
  double tolerance = 0.0;
  std::vector<std::string> settings;
  bool quiet = false;
};

int dump(const DumpArguments& arguments) {
  if (arguments.threads > 0) set_thread_count(arguments.threads);
  std::vector<std::string> settings = arguments.settings;
  if (!arguments.solver.empty()) settings.push_back("solver.name=" + arguments.solver);
  if (arguments.tolerance > 0.0)
    settings.push_back(fmt::format("solver.tolerance={:.17g}", arguments.tolerance));
  SceneSimulation simulation(read_scene(arguments.scene, settings));
  DumpOutcome outcome;
  {
    const auto progress = make_progress(
        arguments.quiet ? ProgressStyle::quiet : ProgressStyle::automatic, simulation.scene());
    outcome = dump_step(simulation, arguments.step, arguments.out, [&](const StepReport& record) {
      progress->on_step(record, arguments.step);
    });
  }
  if (!outcome.status.ok()) {
    fmt::print(stderr, "taut: {}\nNothing was written to {}\n", outcome.status.message,
               arguments.out);
    return 1;
  }
  if (!arguments.quiet)
    fmt::print(
        "{}: the system of step {}, {} unknowns, {} of them free\n  solved by {} in {} iterations, "
        "relative residual {:.3g}\n  taut solve "
        "{} --all   solves it anew\n",
        arguments.out, arguments.step, 3 * simulation.cloth().nodes(),
        simulation.constraints().free_dofs(), outcome.summary.solver, outcome.summary.iterations,
        outcome.summary.relative_residual, arguments.out);
  return 0;
}

}  // namespace

void add_dump_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand(
      "dump", "Write the linear system of one step as files that any tool reads");
  auto arguments = std::make_shared<DumpArguments>();
  verb->add_option("SCENE", arguments->scene, "Scene file (TOML)")->required();
  verb->add_option("--step", arguments->step, "The step whose system is written, from 1")
      ->required()
      ->check(between(1, 1'000'000'000));
  verb->add_option("--out", arguments->out, "Folder to write to; empty, new, or an earlier dump")
      ->required();
  verb->add_option("--solver", arguments->solver, "Linear solver, as solver.name in the scene")
      ->check(solver_name());
  verb->add_option("--tolerance", arguments->tolerance, "As solver.tolerance in the scene")
      ->check(between(1e-14, 0.5));
  verb->add_option("--set", arguments->settings,
                   "Change a key of the scene: key=value; may be repeated")
      ->take_all()
      ->type_name("KEY=VALUE");
  verb->add_option("--threads", arguments->threads,
                   "Threads to use (default: all processors); the results do not depend on it")
      ->check(between(1, 1024));
  verb->add_flag("--quiet", arguments->quiet, "No progress and no report");
  verb->footer(
      "Example: taut dump scenes/ball.toml --set cloth.grid.nodes=[41,41] --step 60 --tolerance "
      "1e-9 --out out/ball_60\n"
      "docs/dump.md describes the files; `taut solve` solves what they hold.");
  verb->callback([arguments, &exit_code] { exit_code = dump(*arguments); });
}

}  // namespace taut::app
