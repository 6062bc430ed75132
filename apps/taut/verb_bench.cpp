#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "bench/benches.h"
#include "plot/bench_figure.h"
#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/base/parallel.h"
#include "taut/linalg/sparse_cholesky.h"
#include "verbs.h"
#ifdef TAUT_WITH_CHOLMOD
#include "taut_cholmod/cholmod.h"
#endif

namespace taut::app {

namespace {

using Json = nlohmann::ordered_json;

struct BenchArguments {
  BenchOptions options;
  std::string json, plot;
  int threads = 1;
};

using BenchFunction = std::function<Json(const BenchOptions&)>;

// The paper's tables hand over their cells.
template <std::vector<ReportRow> (*bench)(const BenchOptions&)>
Json table_rows(const BenchOptions& options) {
  Json rows = Json::array();
  for (const ReportRow& row : bench(options)) rows.push_back(to_json(row, thread_count()));
  return rows;
}

// Both sides get as many.
void set_threads(int count) {
  set_thread_count(count);
#ifdef TAUT_WITH_CHOLMOD
  set_cholmod_threads(count);
#endif
}

int run_bench(const std::string& name, const BenchFunction& bench,
              const BenchArguments& arguments) {
  if (!make_cholesky("cholmod"))
    throw InputError(
        "the benches compare with CHOLMOD, which is not built into this program; build with "
        "-DTAUT_WITH_CHOLMOD=ON");
  if (!arguments.plot.empty()) check_figure_file(arguments.plot);
  set_threads(arguments.threads);
  const MachineFacts machine = machine_facts(true);
  fmt::print("{}\n\n", to_line(machine));
  const Json report{
      {"bench", name}, {"machine", to_json(machine)}, {"rows", bench(arguments.options)}};
  if (!arguments.json.empty()) {
    write_file(arguments.json, report.dump(2) + "\n");
    fmt::print("\nwritten to {}\n", arguments.json);
  }
  if (!arguments.plot.empty()) {
    draw_figure(bench_figure(report), arguments.plot);
    fmt::print("\ndrawn in {}\n", arguments.plot);
  }
  const auto failed = std::ranges::count_if(
      report["rows"], [](const Json& row) { return row.value("failed", false); });
  if (failed == 0) return 0;
  fmt::print(stderr, "taut: {} of {} runs had intersections: their lines above say which\n", failed,
             report["rows"].size());
  return 1;
}

void add_roofline(CLI::App& parent, int& exit_code) {
  CLI::App* verb = parent.add_subcommand(
      "roofline", "Each phase of a step against this machine's measured peak and bandwidth");
  auto arguments = std::make_shared<BenchArguments>();
  verb->add_option("--json", arguments->json, "Write the figures to this file");
  verb->add_option("--threads", arguments->threads, "Threads (default 1)")->check(between(1, 1024));
  verb->add_option("--nodes", arguments->options.nodes,
                   "Sizes: 1681, 6561, 25921 (default: these), 103041, 263169")
      ->check(CLI::IsMember({1681, 6561, 25921, 103041, 263169}));
  verb->add_option("--scenes", arguments->options.scenes,
                   "Folder of the scene files (default: those that came with Taut)");
  verb->footer("Example: taut bench roofline --nodes 25921 --threads 2 --json out/roofline.json");
  verb->callback([=, &exit_code] {
    set_threads(arguments->threads);
    const MachineFacts machine = machine_facts(true);
    fmt::print("{}\n", to_line(machine));
    const nlohmann::ordered_json figures = bench_roofline(arguments->options, machine);
    if (!arguments->json.empty()) write_file(arguments->json, figures.dump(2) + "\n");
    exit_code = 0;
  });
}

struct NewBench {
  CLI::App* verb;
  std::shared_ptr<BenchArguments> arguments;
};

NewBench add_bench(CLI::App& parent, const char* name, const char* description,
                   const BenchFunction& bench, int& exit_code) {
  CLI::App* verb = parent.add_subcommand(name, description);
  auto arguments = std::make_shared<BenchArguments>();
  verb->add_option("--json", arguments->json, "Write the figures to this file");
  verb->add_option("--plot", arguments->plot, "Draw them in this file (.svg or .png)");
  verb->add_option("--threads", arguments->threads,
                   "Threads, also of CHOLMOD's BLAS and of PARDISO (default 1, as in the paper)")
      ->check(between(1, 1024));
  verb->add_option("--scenes", arguments->options.scenes,
                   "Folder of the scene files (default: those that came with Taut)");
  verb->footer(fmt::format("Example: taut bench {0} --json out/{0}.json --plot out/{0}.png", name));
  verb->callback([=, &exit_code] { exit_code = run_bench(name, bench, *arguments); });
  return {verb, arguments};
}

void add_table(CLI::App& parent, const char* name, const char* description,
               const BenchFunction& bench, int& exit_code) {
  const auto [verb, arguments] = add_bench(parent, name, description, bench, exit_code);
  BenchOptions& options = arguments->options;
  verb->add_option("--steps", options.steps, "Steps to measure a cell (default 20)")
      ->check(between(1, 100000));
  verb->add_option("--tolerance", options.tolerance, "Of the paper's stop rule (default 1e-3)")
      ->check(between(1e-14, 1.0));
  verb->add_option("--k-stretch", options.stiffnesses, "Only these stiffnesses, N/m")
      ->check(above(0));
  verb->add_option("--nodes", options.nodes, "Only these sizes: 1681, 6561, 25921")
      ->check(CLI::IsMember({1681, 6561, 25921}));
}

// Flatness and scale: time to equal error on one state.
CLI::App* add_sweep(CLI::App& parent, const char* name, const char* description, const char* sizes,
                    const BenchFunction& bench, int& exit_code) {
  const auto [verb, arguments] = add_bench(parent, name, description, bench, exit_code);
  BenchOptions& options = arguments->options;
  verb->add_flag("--full", options.full, "All sizes and cells: takes much longer than ten minutes");
  verb->add_option("--nodes", options.nodes, sizes)->delimiter(',')->check(above(0));
  verb->add_option("--solver", options.methods,
                   "Only these solvers (default: those worth comparing)")
      ->delimiter(',');
  verb->add_option("--time-limit", options.seconds_limit,
                   "Seconds after which a method is given up (default 20)")
      ->check(above(0));
  if (std::string(name) == "flatness")
    verb->add_option(
            "--k-stretch", options.stiffnesses,
            "Only these of 60, 600, ..., 6000000 N/m (default 60, 6000, 6000000; with --full all)")
        ->delimiter(',')
        ->check(CLI::IsMember({60, 600, 6000, 60000, 600000, 6000000}));
  return verb;
}

void add_integrators(CLI::App& parent, int& exit_code) {
  const auto [verb, arguments] = add_bench(
      parent, "integrators", "Distance from the exact motion against time, an integrator a curve",
      bench_integrators, exit_code);
  verb->add_option("--k-stretch", arguments->options.stiffnesses,
                   "Stiffnesses, N/m (default 60, 6000)")
      ->delimiter(',')
      ->check(above(0));
  verb->add_option("--nodes", arguments->options.nodes, "Nodes of the square sheet (default 1681)")
      ->expected(1)
      ->check(above(0));
}

void add_contact(CLI::App& parent, int& exit_code) {
  const auto [verb, arguments] = add_bench(
      parent, "contact",
      "What contact costs a step, by phase; or --stress: every contact scene and jittered copies",
      bench_contact, exit_code);
  verb->add_flag("--full", arguments->options.full,
                 "clump with 25,921 nodes, as in the paper (default 6,561)");
  verb->add_option("--nodes", arguments->options.nodes, "Nodes of both sheets, a square number")
      ->expected(1)
      ->check(above(0));
  verb->add_option("--stress", arguments->options.stress,
                   "Run each contact scene and this many jittered copies, and report how they end")
      ->check(between(0, 1000));
  verb->add_option("--frames", arguments->options.stress_frames,
                   "Of each such run, whatever the scene says (default 200)")
      ->check(above(0));
  verb->add_option("--scene", arguments->options.methods, "Only these scenes of the stress test")
      ->delimiter(',');
  verb->add_option("--judge", arguments->options.judge,
                   "Let this program judge every frame of the stress test (the tests' build has "
                   "one: tests/contact/judge/judge)");
}

}  // namespace

void add_bench_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb =
      app.add_subcommand("bench", "Measure the paper's tables and more on this machine");
  verb->require_subcommand(1);
  verb->footer("Example: taut bench table2 --nodes 6561");
  add_table(*verb, "table1", "Paper, Table 1: MPCG against uPCG, pinned and draping cloth",
            table_rows<bench_table1>, exit_code);
  add_table(*verb, "table2",
            "Paper, Table 2: MPCG, CHOLMOD, PARDISO and corePCG on a sheet hit by a ball",
            table_rows<bench_table2>, exit_code);
  add_sweep(*verb, "flatness",
            "Time to equal error over stiffness, time step, shear and bend; the core's bound "
            "beside what is measured",
            "Nodes of the square sheet (default 6561, with --full 25921)", bench_flatness,
            exit_code);
  add_sweep(*verb, "scale",
            "Time to equal error and memory over the number of nodes, with fitted exponents",
            "Only these sizes, square numbers (default 1681 to 103041, with --full to 1002001)",
            bench_scale, exit_code);
  add_integrators(*verb, exit_code);
  const auto frames = add_bench(
      *verb, "frames", "Paper, Section 3, 'improper U': iterations with three choices of U",
      bench_frames, exit_code);
  frames.verb
      ->add_option("--tolerance", frames.arguments->options.tolerance,
                   "Of the stop rule (default 1e-3)")
      ->check(between(1e-14, 1.0));
  add_contact(*verb, exit_code);
  add_roofline(*verb, exit_code);
}

}  // namespace taut::app
