#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "solve/solve_figure.h"
#include "solve/solve_report.h"
#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/base/parallel.h"
#include "taut/results/system_files.h"
#include "verbs.h"

namespace taut::app {

namespace {

struct SolveArguments {
  std::string folder;
  SystemFiles files;
  std::vector<std::string> solvers;
  bool all = false;
  SolverOptions options{.tolerance = 1e-6};
  SolveLimits limits;
  std::optional<double> residual;
  std::string history, json, plot;
  bool wants_json = false, spectrum = false;
  int threads = 0;
};

// What the command line names replaces what the folder holds.
SystemFiles chosen_files(const SolveArguments& arguments) {
  if (arguments.folder.empty()) return arguments.files;
  SystemFiles files = files_of_dump(arguments.folder);
  for (const auto file : {&SystemFiles::rhs, &SystemFiles::constraints, &SystemFiles::z,
                          &SystemFiles::core, &SystemFiles::guess})
    if (!(arguments.files.*file).empty()) files.*file = arguments.files.*file;
  return files;
}

std::vector<std::string> chosen_solvers(const SolveArguments& arguments) {
  if (arguments.all) return distinct_solvers();
  return arguments.solvers.empty() ? std::vector<std::string>{"core_pcg"} : arguments.solvers;
}

nlohmann::ordered_json facts_of(const SolveArguments& arguments, const StoredSystem& stored) {
  nlohmann::ordered_json facts = nlohmann::ordered_json::object();
  if (!arguments.folder.empty())
    facts = dump_facts((std::filesystem::path(arguments.folder) / "meta.json").string());
  if (!facts.contains("scene"))
    facts["scene"] =
        arguments.folder.empty() ? arguments.files.matrix.filename().string() : arguments.folder;
  facts["unknowns"] = stored.unknowns();
  if (stored.system().constraints) facts["free_dofs"] = stored.system().constraints->free_dofs();
  return facts;
}

void print_table(const std::vector<SolverRow>& rows, const Reference& reference,
                 const StoredSystem& stored, double tolerance) {
  const LinearSystem system = stored.system();
  fmt::print("{} unknowns, {} free; tolerance {:g}\n", stored.unknowns(),
             system.constraints ? system.constraints->free_dofs() : stored.unknowns(), tolerance);
  if (reference.x.empty())
    fmt::print("no reference solution, so no A-norm error: {}\n", reference.report.status.message);
  fmt::print("\n{}", solve_table(rows));
  for (const auto& [summary, error, solves, options] : rows)
    if (!summary.remark.empty()) fmt::print("{}: {}\n", summary.solver, summary.remark);
}

void write_histories(const SolveArguments& arguments, const std::vector<SolverRow>& rows,
                     const LinearSystem& system, const Reference& reference,
                     const std::string& title) {
  std::vector<HistoryPoint> points;
  for (const SolverRow& row : rows) {
    const auto history = record_history(system, row, reference);
    points.insert(points.end(), history.begin(), history.end());
  }
  if (!arguments.history.empty()) write_file(arguments.history, history_csv(points));
  if (!arguments.plot.empty()) draw_figure(solve_figure(rows, points, title), arguments.plot);
}

// Someone else's matrix comes without a stop rule of ours: there, the residual is what people mean
// by converged.
SolveLimits limits_of(const SolveArguments& arguments) {
  SolveLimits limits = arguments.limits;
  limits.residual =
      arguments.residual.value_or(arguments.folder.empty() ? arguments.options.tolerance : 0.0);
  return limits;
}

std::vector<SolverRow> measure_all(const SolveArguments& arguments, const LinearSystem& system,
                                   const Reference& reference) {
  const std::vector<std::string> names = chosen_solvers(arguments);
  const bool terminal = ::isatty(STDERR_FILENO);
  SolverOptions options = arguments.options;
  std::vector<SolverRow> rows;
  for (const std::string& name : names) {
    if (terminal)
      fmt::print(stderr, "\r\033[K{} of {}: {} ...", rows.size() + 1, names.size(), name);
    options.name = name;
    rows.push_back(measure_solver(system, options, reference, limits_of(arguments)));
  }
  if (terminal) fmt::print(stderr, "\r\033[K");
  return rows;
}

// A wrong name is bad usage, told before minutes of reading and solving.
void check_solver_names(const SolveArguments& arguments) try {
  SolverOptions options = arguments.options;
  for (const std::string& name : arguments.solvers) options.name = name, make_solver(options);
} catch (const InputError& error) {
  throw CLI::ValidationError("--solver", error.what());
}

int solve(const SolveArguments& arguments) {
  if (arguments.threads > 0) set_thread_count(arguments.threads);
  if (!arguments.plot.empty()) check_figure_file(arguments.plot);
  const StoredSystem stored(chosen_files(arguments));
  const LinearSystem system = stored.system();
  const Reference reference = make_reference(system);
  const std::vector<SolverRow> rows = measure_all(arguments, system, reference);
  const nlohmann::ordered_json facts = facts_of(arguments, stored);
  if (!arguments.history.empty() || !arguments.plot.empty())
    write_histories(
        arguments, rows, system, reference,
        fmt::format("{}: {} unknowns", facts.value("scene", std::string()), stored.unknowns()));

  CoreSpectrum spectrum;
  if (arguments.spectrum) spectrum = measure_core_spectrum(system, arguments.options.tolerance);
  const bool json_to_stdout = arguments.wants_json && arguments.json.empty();
  if (!json_to_stdout) print_table(rows, reference, stored, arguments.options.tolerance);
  if (!json_to_stdout && arguments.spectrum)
    fmt::print("\n{}", spectrum_text(spectrum, arguments.options.tolerance));
  if (arguments.wants_json) {
    nlohmann::ordered_json report = solve_json(rows, facts);
    if (arguments.spectrum) report["core"] = to_json(spectrum);
    const std::string json = report.dump(2) + "\n";
    json_to_stdout ? fmt::print("{}", json) : write_file(arguments.json, json);
  }
  bool all_converged = true;
  for (const auto& [summary, error, solves, options] : rows) {
    if (summary.status.ok()) continue;
    all_converged = false;
    fmt::print(stderr, "taut: {}: {}{}{}\n", summary.solver, name_of(summary.status.outcome),
               summary.status.message.empty() ? "" : ": ", summary.status.message);
  }
  return all_converged ? 0 : 1;
}

void add_system_options(CLI::App& verb, SolveArguments& arguments) {
  CLI::Option* folder =
      verb.add_option("DIR", arguments.folder, "Folder that `taut dump` has written");
  CLI::Option* matrix =
      verb.add_option("--matrix", arguments.files.matrix,
                      "Symmetric positive definite matrix (Matrix Market, also .mtx.gz)");
  matrix->excludes(folder);
  verb.add_option("--rhs", arguments.files.rhs,
                  "Right-hand side b (default with --matrix: A times ones)");
  verb.add_option("--constraints", arguments.files.constraints,
                  "S.mtx or U.mtx of a dump: then three rows are a node");
  verb.add_option("--z", arguments.files.z,
                  "Prescribed part of the solution, with --constraints (default: 0)");
  verb.add_option("--core", arguments.files.core,
                  "The entries of A that core_pcg factorises (default: the diagonal)");
  verb.add_option("--guess", arguments.files.guess,
                  "Where iterative methods start (default: 0, or the dump's guess)");
}

}  // namespace

void add_solve_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand(
      "solve", "Solve a linear system of files with any method; print iterations, times, errors");
  auto arguments = std::make_shared<SolveArguments>();
  add_system_options(*verb, *arguments);
  CLI::Option* names =
      verb->add_option("--solver", arguments->solvers,
                       "Solvers, several with commas or repeated (default: core_pcg)")
          ->delimiter(',')
          ->take_all();
  verb->add_flag("--all", arguments->all, "All solvers of this program")->excludes(names);
  verb->add_option("--tolerance", arguments->options.tolerance,
                   "Of the iterative methods' stop rule (default: 1e-6)")
      ->check(between(1e-16, 1.0));
  verb->add_option("--max-iterations", arguments->options.max_iterations,
                   "Default: ten times the unknowns, at least 1000")
      ->check(above(0));
  verb->add_option("--reordering", arguments->options.reordering,
                   "core_pcg: reorder `vectors` in each iteration or `matrix` once")
      ->check(CLI::IsMember({"vectors", "matrix"}));
  verb->add_option("--residual", arguments->residual,
                   "Converged means this true relative residual too, 2-norm; 0: the stop rule is "
                   "enough (default with --matrix: the "
                   "tolerance, else 0)")
      ->check(between(0.0, 1.0));
  verb->add_option("--time-limit", arguments->limits.seconds,
                   "Seconds for one solve of an iterative method (default: 60)")
      ->check(above(0));
  verb->add_option(
          "--repeat", arguments->limits.repeats,
          "Solves whose median times are given (default: 5, or 1 when one takes over 0.2 s)")
      ->check(between(1, 1000));
  CLI::Option* json =
      verb->add_option("--json", arguments->json,
                       "Write the figures to FILE; without FILE to stdout, instead of the table")
          ->expected(0, 1)
          ->type_name("[FILE]");
  verb->add_option("--history", arguments->history,
                   "Write a CSV of every iteration: "
                   "solver,iteration,stop_value,residual,anorm_error,time_ms")
      ->type_name("FILE");
  verb->add_option("--plot", arguments->plot, "Draw A-norm error against time, a curve a method")
      ->type_name("FILE.svg|png");
  verb->add_flag("--spectrum", arguments->spectrum,
                 "Measure the core's eigenvalues (Lanczos) and print them beside their bound");
  verb->add_option("--threads", arguments->threads, "Threads to use (default: all processors)")
      ->check(between(1, 1024));
  verb->footer(
      "Example: taut solve out/ball_60 --solver core_pcg,mpcg,cholmod --tolerance 1e-3\n"
      "Example: taut solve --matrix A.mtx --rhs b.mtx --all --json out/solvers.json --plot "
      "out/solvers.svg\n"
      "A-norm error: |S(x - x*)|_A / |S x*|_A against a refined direct solution x*. Exit code 1 "
      "when a solver did not converge.");
  verb->callback([=, &exit_code] {
    if (arguments->folder.empty() && arguments->files.matrix.empty())
      throw CLI::RequiredError(std::filesystem::is_directory(arguments->json)
                                   ? "DIR (it was taken for the FILE of --json: put DIR first)"
                                   : "DIR or --matrix");
    arguments->wants_json = json->count() > 0;
    check_solver_names(*arguments);
    exit_code = solve(*arguments);
  });
}

}  // namespace taut::app
