#include <fmt/format.h>

#include <filesystem>

#include "plot/bench_figure.h"
#include "plot/stats_figure.h"
#include "taut/base/error.h"
#include "taut/base/file.h"
#include "verbs.h"

namespace taut::app {

namespace {

namespace fs = std::filesystem;

struct PlotArguments {
  std::string what, out;
};

std::string title_of_run(const fs::path& folder) {
  const fs::path name = fs::weakly_canonical(folder).filename();
  return name.empty() ? folder.string() : name.string();
}

Figure figure_of_run(const fs::path& folder) {
  const fs::path stats = folder / "stats.csv";
  if (!fs::exists(stats))
    throw InputError(
        {folder.string()},
        "holds no stats.csv: it is no result of `taut run`, or one that has not done a step yet");
  const Columns columns = read_columns(stats);
  const std::size_t steps = columns.at("time").size();
  if (steps == 0)
    throw InputError({stats.string()}, "holds no step yet; the run may just have begun");
  const bool ended = fs::exists(folder / "summary.json");
  return stats_figure(
      columns, title_of_run(folder),
      fmt::format("{} steps{}", steps,
                  ended ? "" : "; the run has not ended, or was interrupted (no summary.json)"));
}

int plot(const PlotArguments& arguments) {
  const fs::path what = arguments.what;
  const bool run = fs::is_directory(what);
  fs::path out = arguments.out;
  if (out.empty()) out = run ? what / "stats.svg" : fs::path(what).replace_extension(".svg");
  check_figure_file(out);
  draw_figure(run ? figure_of_run(what) : bench_figure(read_report(what)), out);
  fmt::print("{}\n", out.string());
  return 0;
}

}  // namespace

void add_plot_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb =
      app.add_subcommand("plot", "Draw a run's statistics over time, or the figures of a bench");
  auto arguments = std::make_shared<PlotArguments>();
  verb->add_option("RESULT", arguments->what,
                   "DIR of `taut run`, also one that is still running; or FILE.json: what --json "
                   "of a bench or of `taut solve` has written")
      ->required();
  verb->add_option("--out", arguments->out, "Where to draw it (default: DIR/stats.svg, FILE.svg)")
      ->type_name("FILE.svg|png");
  verb->footer(
      "Example: taut plot out/ball\n"
      "Example: taut plot out/flatness.json --out out/flatness.png\n"
      "Drawn by gnuplot. A run's panels: iterations with their bound, milliseconds by phase, "
      "energies, largest stretch, contacts and "
      "constraints.");
  verb->callback([=, &exit_code] { exit_code = plot(*arguments); });
}

}  // namespace taut::app
