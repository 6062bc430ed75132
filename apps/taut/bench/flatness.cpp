// taut bench flatness: is a method's cost flat in the stiffness, and where does it stop being so?
//
// One state of the ball scene, some steps into contact (k_stretch = 6000, h = 3.67 ms), gives every
// cell its positions, velocities, constraints and friction impulses; a cell assembles them anew
// with its own stiffnesses and step. So between two cells nothing differs but what the table says.
// The iterative methods start at zero, so that the bound of a wanted A-norm error is the bound of
// the error's reduction.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/benches.h"
#include "bench/equal_error.h"
#include "bench/table.h"
#include "taut/base/error.h"
#include "taut/base/timer.h"
#include "taut/constraint/constraint_set.h"
#include "taut/contact/solid_contact.h"
#include "taut/core/core_bound.h"
#include "taut/scene/scene_file.h"
#include "taut/sim/cloth_model.h"
#include "taut/solve/core_spectrum.h"
#include "taut/solve/linear_system.h"
#include "taut/solve/reference.h"
#include "taut/solve/solver_registry.h"
#include "taut/step/state.h"
#include "taut/step/stepper.h"

namespace taut::app {

namespace {

using Json = nlohmann::ordered_json;

struct FlatnessCell {
  double k_stretch, k_shear, k_bend, h;
};

constexpr double all_k_stretch[] = {60, 600, 6e3, 6e4, 6e5, 6e6},
                 all_h[] = {1e-3, 3.67e-3, 16.7e-3, 33e-3};
constexpr std::pair<double, double> all_shear_bend[] = {{0.3, 0.05}, {30, 5}, {600, 50}};

std::vector<FlatnessCell> cells_of(const BenchOptions& options) {
  std::vector<int> chosen = options.stiffnesses;
  if (chosen.empty() && !options.full) chosen = {60, 6000, 6000000};
  const auto wanted = [&](double k) {
    return chosen.empty() ||
           std::ranges::any_of(chosen, [&](int w) { return std::abs(w - k) < 0.5; });
  };
  std::vector<FlatnessCell> cells;
  for (const double h : all_h)
    for (const auto& [shear, bend] : all_shear_bend)
      for (const double k : all_k_stretch)
        if (wanted(k)) cells.push_back({k, shear, bend, h});
  return cells;
}

// The bound on the reduction of the A-norm error (docs/mathematics.md, 5), not on the stop rule's.
int bound_iterations(double rho, double error) {
  return static_cast<int>(std::ceil(0.5 * std::sqrt(2.0 * (1.0 + rho)) * std::log(2.0 / error)));
}

class Flatness {
 public:
  Flatness(const BenchOptions& options, int side)
      : options_(options), side_(side), methods_(methods_of(options)), table_(header()) {}

  Json run() {
    const std::string grid = fmt::format("cloth.grid.nodes=[{0},{0}]", side_);
    SceneSimulation simulation(
        read_scene(options_.scenes + "/ball.toml",
                   std::vector<std::string>{grid, "cloth.k_stretch=6000", "time.step=3.67e-3",
                                            "time.frames=100000", "solver.name=core_pcg"}));
    fmt::print(stderr, "flatness: {} nodes, up to {} steps into contact ...\n", side_ * side_,
               steps_in_contact);
    run_into_contact(simulation, steps_in_contact);
    simulation.on_solved = [&](const SolveSummary&) {
      if (rows_.empty()) measure_cells(simulation);
    };
    StepReport record;
    simulation.step(record);
    print_end();
    return std::move(rows_);
  }

 private:
  static constexpr int steps_in_contact = 5;

  std::vector<std::string> header() const {
    std::vector<std::string> header{"h ms", "k_shear",     "k_bend", "k_strh",
                                    "rho",  "eigenvalues", "bound",  "its"};
    for (const std::string& method : methods_) header.push_back(method);
    return header;
  }

  void measure_cells(SceneSimulation& simulation) {
    const std::vector<FlatnessCell> cells = cells_of(options_);
    const Timer timer;
    for (const FlatnessCell& cell : cells) {
      const double left =
          done_ > 0 ? timer.milliseconds() / 6e4 / done_ *
                          static_cast<double>(cells.size() - static_cast<std::size_t>(done_))
                    : NAN;
      fmt::print(stderr, "flatness: cell {} of {}: h = {:g} ms, k_shear = {:g}, k_strh = {:g}{}\n",
                 done_ + 1, cells.size(), 1e3 * cell.h, cell.k_shear, cell.k_stretch,
                 done_ > 0 ? fmt::format("; about {:.1f} min left", left) : "");
      measure_cell(simulation, cell);
      ++done_;
    }
    fmt::print("{}\n", table_.text());
  }

  void measure_cell(SceneSimulation& simulation, const FlatnessCell& cell) {
    Scene scene = simulation.scene();
    SpringMaterial& material = scene.cloths[0].material;
    material.k_stretch = cell.k_stretch, material.k_shear = cell.k_shear,
    material.k_bend = cell.k_bend;
    const ClothModel cloth(make_world(scene).world);
    const auto stepper_for = [&](const char* solver) {
      auto stepper = std::make_unique<Stepper>(
          cloth.nodes(), cloth.force_models(), cloth.external(),
          IntegratorKind::semi_implicit_euler, SolverOptions{.name = solver});
      stepper->begin(simulation.state(), cell.h);
      // Once through, for z and the impulses to be taken over; what it finds is not used.
      const auto through = make_solver({.name = "mpcg", .tolerance = 0.5, .max_iterations = 1});
      stepper->solve(simulation.constraints(), simulation.contact().impulses(), *through);
      return stepper;
    };
    // Two: `auto` is given other cores.
    const auto stepper = stepper_for("core_fast"), stepper_of_auto = stepper_for("auto");
    LinearSystem system = stepper->system(), of_auto = stepper_of_auto->system();
    system.guess = of_auto.guess = {};
    const double rho = stepper->remainder_ratio();
    const CoreSpectrum spectrum = measure_core_spectrum(system, options_.tolerance);
    const std::vector<double> reference = reference_solution(system);
    if (reference.empty())
      throw InputError(fmt::format("flatness: no reference solution at k_stretch = {:g}, h = {:g}",
                                   cell.k_stretch, cell.h));
    Json facts{{"scene", "ball"},
               {"nodes", side_ * side_},
               {"k_stretch", cell.k_stretch},
               {"k_shear", cell.k_shear},
               {"k_bend", cell.k_bend},
               {"h", cell.h},
               {"integrator", "semi_implicit_euler"},
               {"rho", rho}};
    facts["rho_of_auto"] = of_auto.core.rho;
    std::vector<EqualErrorResult> results;
    for (const std::string& method : methods_) {
      results.push_back(measure_equal_error(method == "auto" ? of_auto : system, method, reference,
                                            options_.seconds_limit));
      add_row(facts, spectrum, rho, results.back());
    }
    put_ratios(results.size());
    add_line(cell, rho, spectrum, results);
  }

  void add_row(const Json& facts, const CoreSpectrum& spectrum, double rho,
               const EqualErrorResult& result) {
    Json row = facts;
    put(row, result);
    if (solver_traits(result.solver).bounds_iterations) {
      row["lambda_min"] = spectrum.smallest, row["lambda_max"] = spectrum.largest,
      row["cond"] = spectrum.largest / spectrum.smallest;
      row["cond_bound"] = 2.0 * (1.0 + rho);
      row["bound_iterations"] = bound_iterations(rho, wanted_errors.back());
      if (result.to.back().reached() &&
          result.to.back().iterations > bound_iterations(rho, wanted_errors.back()))
        ++bound_broken_;
    }
    rows_.push_back(std::move(row));
  }

  // To CHOLMOD's time in the same cell, for the method's time to the larger of the wanted errors.
  void put_ratios(std::size_t count) {
    const std::size_t first = rows_.size() - count;
    double full = 0.0;
    for (std::size_t r = first; r < rows_.size(); ++r)
      if (rows_[r]["solver"] == "cholmod") full = rows_[r].value("to_1e-3_ms", 0.0);
    for (std::size_t r = first; r < rows_.size(); ++r)
      if (full > 0.0 && rows_[r].contains("to_1e-3_ms"))
        rows_[r]["ratio_to_cholmod_full"] = rows_[r]["to_1e-3_ms"].get<double>() / full;
  }

  void add_line(const FlatnessCell& cell, double rho, const CoreSpectrum& spectrum,
                const std::vector<EqualErrorResult>& results) {
    const auto core = std::ranges::find(methods_, "core_pcg");
    std::vector<std::string> line{
        fmt::format("{:g}", 1e3 * cell.h),
        fmt::format("{:g}", cell.k_shear),
        fmt::format("{:g}", cell.k_bend),
        fmt::format("{:.0e}", cell.k_stretch),
        fmt::format("{:.3g}", rho),
        fmt::format("{:.2g} .. {:.3g}", spectrum.smallest, spectrum.largest),
        fmt::format("{}", bound_iterations(rho, wanted_errors[0])),
        core == methods_.end()
            ? ""
            : fmt::format(
                  "{}",
                  results[static_cast<std::size_t>(core - methods_.begin())].to[0].iterations)};
    for (const EqualErrorResult& result : results)
      line.push_back(fmt::format("{} / {}", text_of(result.to[0]), text_of(result.to[1])));
    // Lanczos comes to the extreme eigenvalues from within, so the bounds hold for it exactly but
    // for rounding.
    if (spectrum.largest > 2.0 * (1 + 1e-9) || spectrum.smallest < (1 - 1e-9) / (1.0 + rho))
      ++bound_broken_;
    if (!last_h_.empty() && last_h_ != line[0]) table_.add_rule();
    last_h_ = line[0];
    table_.add(std::move(line));
  }

  void print_end() const {
    fmt::print(
        "{} nodes; one state of the ball scene, assembled with each cell's stiffnesses and step. A "
        "method's column: ms (#iterations) to an "
        "A-norm error of 1e-3 / 1e-6,\n"
        "set-up included; '-': not reached in {:g} s. rho, eigenvalues of P^-1 A (Lanczos), bound "
        "and its: of core_pcg, for 1e-3.\n",
        side_ * side_, options_.seconds_limit);
    if (bound_broken_ == 0)
      fmt::print(
          "The bound (eigenvalues within 1/(1 + rho) .. 2, iterations) held in all {} cells.\n",
          done_);
    else
      fmt::print("THE BOUND WAS BROKEN in {} of {} cells.\n", bound_broken_, done_);
  }

  BenchOptions options_;
  int side_;
  std::vector<std::string> methods_;
  TextTable table_;
  std::string last_h_;
  Json rows_ = Json::array();
  int done_ = 0, bound_broken_ = 0;
};

}  // namespace

Json bench_flatness(const BenchOptions& options) {
  Json rows = Json::array();
  for (const int nodes :
       options.nodes.empty() ? std::vector<int>{options.full ? 25921 : 6561} : options.nodes) {
    for (Json& row : Flatness(options, side_of(nodes)).run()) rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace taut::app
