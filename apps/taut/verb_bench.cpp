#include <fmt/format.h>

#include "bench/benches.h"
#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/base/parallel.h"
#include "taut/linalg/sparse_cholesky.h"
#include "verbs.h"

namespace taut::app {

namespace {

struct BenchArguments {
  BenchOptions options;
  std::string json;
  int threads = 1;
};

using BenchFunction = std::vector<ReportRow> (*)(const BenchOptions&);

int run_bench(BenchFunction bench, const BenchArguments& arguments) {
  if (!make_cholesky("cholmod")) throw InputError("the paper's tables compare with CHOLMOD, which is not built into this program; build with -DTAUT_WITH_CHOLMOD=ON");
  set_thread_count(arguments.threads);
  const MachineFacts machine = machine_facts(true);
  fmt::print("{}\n\n", to_line(machine));
  const std::vector<ReportRow> rows = bench(arguments.options);
  if (!arguments.json.empty()) {
    write_report(arguments.json, machine, rows);
    fmt::print("\nwritten to {}\n", arguments.json);
  }
  return 0;
}

void add_roofline(CLI::App& parent, int& exit_code) {
  CLI::App* verb = parent.add_subcommand("roofline", "Each phase of a step against this machine's measured peak and bandwidth");
  auto arguments = std::make_shared<BenchArguments>();
  verb->add_option("--json", arguments->json, "Write the figures to this file");
  verb->add_option("--threads", arguments->threads, "Threads (default 1)")->check(CLI::Range(1, 1024));
  verb->add_option("--nodes", arguments->options.nodes, "Sizes: 1681, 6561, 25921 (default: these), 103041, 263169")
      ->check(CLI::IsMember({1681, 6561, 25921, 103041, 263169}));
  verb->add_option("--scenes", arguments->options.scenes, "Folder of the scene files (default: scenes)");
  verb->footer("Example: taut bench roofline --nodes 25921 --threads 2 --json out/roofline.json");
  verb->callback([=, &exit_code] {
    set_thread_count(arguments->threads);
    const MachineFacts machine = machine_facts(true);
    fmt::print("{}\n", to_line(machine));
    const nlohmann::ordered_json figures = bench_roofline(arguments->options, machine);
    if (!arguments->json.empty()) write_file(arguments->json, figures.dump(2) + "\n");
    exit_code = 0;
  });
}

CLI::App* add_bench(CLI::App& parent, const char* name, const char* description, BenchFunction bench, int& exit_code) {
  CLI::App* verb = parent.add_subcommand(name, description);
  auto arguments = std::make_shared<BenchArguments>();
  BenchOptions& options = arguments->options;
  verb->add_option("--json", arguments->json, "Write the figures to this file");
  verb->add_option("--threads", arguments->threads, "Threads for Taut's own parts (default 1, as in the paper; CHOLMOD's BLAS always has one)")->check(CLI::Range(1, 1024));
  verb->add_option("--steps", options.steps, "Steps to measure a cell (default 20)")->check(CLI::Range(1, 100000));
  verb->add_option("--tolerance", options.tolerance, "Of the paper's stop rule (default 1e-3)")->check(CLI::Range(1e-14, 1.0));
  verb->add_option("--k-stretch", options.stiffnesses, "Only these stiffnesses, N/m")->check(CLI::PositiveNumber);
  verb->add_option("--nodes", options.nodes, "Only these sizes: 1681, 6561, 25921")->check(CLI::IsMember({1681, 6561, 25921}));
  verb->add_option("--scenes", options.scenes, "Folder of the scene files (default: scenes)");
  verb->footer(fmt::format("Example: taut bench {} --json out/{}.json", name, name));
  verb->callback([=, &exit_code] { exit_code = run_bench(bench, *arguments); });
  return verb;
}

}  // namespace

void add_bench_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand("bench", "Measure the paper's tables and more on this machine");
  verb->require_subcommand(1);
  verb->footer("Example: taut bench table2 --nodes 6561");
  add_bench(*verb, "table1", "Paper, Table 1: MPCG against uPCG, pinned and draping cloth", bench_table1, exit_code);
  add_bench(*verb, "table2", "Paper, Table 2: MPCG, CHOLMOD, PARDISO and corePCG on a sheet hit by a ball", bench_table2, exit_code);
  add_roofline(*verb, exit_code);
}

}  // namespace taut::app
