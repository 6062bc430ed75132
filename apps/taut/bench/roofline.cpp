#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "bench/benches.h"
#include "bench/median.h"
#include "bench/peak.h"
#include "bench/table.h"
#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/constraint/reduction.h"
#include "taut/contact/solid_contact.h"
#include "taut/core/block_remainder.h"
#include "taut/linalg/block_cholesky.h"
#include "taut/linalg/sparse_cholesky.h"
#include "taut/scene/scene_file.h"
#include "taut/sim/cloth_model.h"
#include "taut/solve/full_space.h"
#include "taut/solve/linear_system.h"
#include "taut/solve/solver.h"
#include "taut/step/state.h"
#include "taut/step/stepper.h"

namespace taut::app {

namespace {

struct Grid {
  int side;
  const char* step;  // s
};
constexpr Grid grids[] = {
    {41, "6.67e-3"}, {81, "5.55e-3"}, {161, "3.67e-3"}, {321, "1.84e-3"}, {513, "1.15e-3"}};

double bytes_of(std::span<const std::uint8_t> blocks) {
  return 72.0 * static_cast<double>(std::ranges::count(blocks, std::uint8_t{1}));
}

// Flops of one spring's gradient and stiffness, of which damping and the sums into A are a third;
// an estimate, counted in element/spring_law.cpp.
constexpr double flops_per_spring_block = 120.0;

// All phases of one step's system at the state the simulation is in.
class Phases {
 public:
  Phases(SceneSimulation& simulation, std::vector<RooflineRow>& rows)
      : simulation_(simulation), rows_(rows) {}

  void measure() {
    Stepper& stepper = simulation_.stepper();
    const LinearSystem system = stepper.system();
    const BlockCsr& a = *system.matrix;
    const std::size_t n = system.rhs.size();
    std::vector<double> x(n, 1.0), y(n), load(n);

    const double values = static_cast<double>(a.values.size());
    const Offset off_diagonal = (a.pattern->blocks() - a.rows()) / 2;
    const State state = simulation_.state();
    Stepper other(simulation_.cloth().nodes(), simulation_.cloth().force_models(),
                  simulation_.cloth().external(), simulation_.scene().time.integrator, {});
    add("assembly", flops_per_spring_block * static_cast<double>(off_diagonal),
        8.0 * values + 6.0 * 8.0 * static_cast<double>(n), "double",
        median_ms([&] { other.begin(state, simulation_.scene().time.step); }));
    add("product", 2.0 * values, static_cast<double>(multiply_bytes(a)), "double",
        median_ms([&] { multiply(a, x, y); }));
    Reduction reduction;
    add("reduction, copied", 0.0, 16.0 * values, "double",
        median_ms([&] { reduction.update(a, system.constraints); }));
    add("reduction, in place", 0.0, 16.0 * static_cast<double>(n), "double",
        median_ms([&] { load_without_prescribed(system, load); }));
    for (const auto precision :
         {CholeskyPrecision::single_precision, CholeskyPrecision::double_precision})
      measure_factor(system, load, precision);
    measure_solver(system, "core_fast", repetitions);
    measure_solver(system, "block_cholesky", repetitions);
    if (make_cholesky("cholmod")) {
      measure_solver(system, "cholmod", 3);
      measure_solver(system, "cholmod_reused_analysis", 3);
    }
  }

 private:
  void measure_factor(const LinearSystem& system, std::span<const double> load,
                      CholeskyPrecision precision) {
    const bool single = precision == CholeskyPrecision::single_precision;
    const char* name = single ? "single" : "double";
    BlockCholesky factor(precision);
    Timer timer;
    if (const Status status =
            factor.analyze(system.matrix->pattern, system.core.mask, BlocksLeftOut::without_place);
        !status.ok())
      throw InputError(status.message);
    if (single) add("core: analysis, once", 0.0, 0.0, name, timer.milliseconds());
    Status status;
    const double factor_ms =
        median_ms([&] { status = factor.factorize(*system.matrix, free_basis(system)); });
    if (!status.ok()) throw InputError(status.message);
    const double fused_ms =
        median_ms([&] { factor.factorize(*system.matrix, free_basis(system), load); });
    const BlockCholeskyStatistics s = factor.block_statistics();
    add("core: factor", s.flops, s.panel_bytes + bytes_of(factor.analyzed_blocks()), name,
        factor_ms);
    add("core: factor + forward", s.flops + 2.0 * s.factor_entries,
        s.panel_bytes + bytes_of(factor.analyzed_blocks()), name, fused_ms);
    std::vector<double> x(load.size());
    add("core: forward", 2.0 * s.factor_entries, s.panel_bytes, name,
        median_ms([&] { factor.solve_forward(load); }));
    add("core: backward", 2.0 * s.factor_entries, s.panel_bytes, name,
        median_ms([&] {
          factor.solve_forward(load);
          factor.solve_backward(0.0, x);
        }) - rows_.back().milliseconds);
    if (single) measure_remainder(system, factor);
  }

  // What core_fast multiplies by instead of A.
  void measure_remainder(const LinearSystem& system, const BlockCholesky& factor) {
    BlockRemainder remainder;
    remainder.analyze(system.matrix->pattern, factor.analyzed_blocks(), factor.parallelograms());
    remainder.set_replaced(true);
    const std::size_t n = system.rhs.size();
    std::vector<double> r(n, 1.0), c(n, 1.0), p(n, 0.0), q(n);
    const double values = static_cast<double>(remainder.nonzeros());
    add("outside the core: copied", 0.0,
        8.0 * static_cast<double>(system.matrix->values.size()) + 4.0 * values, "single",
        median_ms([&] { remainder.update(*system.matrix); }));
    add("outside the core: product", 2.0 * values + 5.0 * static_cast<double>(n),
        4.0 * values + 6.0 * 8.0 * static_cast<double>(n), "single",
        median_ms([&] { remainder.advance(0.5, r, c, p, q); }));
  }

  void measure_solver(const LinearSystem& system, const char* name, int runs_wanted) {
    SolverOptions options;
    options.name = name;
    options.reuse_analysis = false;
    const auto solver = make_solver(options);
    std::vector<double> x(system.rhs.size());
    std::vector<SolveSummary> runs;
    for (int k = 0; k <= runs_wanted; ++k) runs.push_back(solver->solve(system, x));
    runs.erase(runs.begin());
    std::ranges::sort(runs, {}, [](const SolveSummary& s) { return s.total_ms(); });
    const SolveSummary& s = runs[runs.size() / 2];
    add(fmt::format("{}, {} iterations: set-up", name, s.iterations), 0.0, 0.0, s.precision,
        s.reduce_ms + s.order_ms + s.factor_ms);
    add(fmt::format("{}, {} iterations: solve", name, s.iterations), 0.0, 0.0, s.precision,
        s.solve_ms);
  }

  void add(std::string phase, double flops, double bytes, const char* precision,
           double milliseconds) {
    rows_.push_back({simulation_.cloth().nodes(), std::move(phase), precision, flops, bytes,
                     milliseconds, bytes > 0.0 ? read_rate(bytes) : 0.0});
  }

  SceneSimulation& simulation_;
  std::vector<RooflineRow>& rows_;
};

std::string share(double value, double peak) {
  return value > 0.0 && peak > 0.0 ? fmt::format("{:.0f} %", 100.0 * value / peak) : "-";
}

nlohmann::ordered_json phase_json(const RooflineRow& r, const PeakRates& peak,
                                  const MachineFacts& machine) {
  nlohmann::ordered_json json{
      {"scene", "ball"},          {"nodes", r.nodes},           {"phase", r.phase},
      {"precision", r.precision}, {"threads", machine.threads}, {"ms", r.milliseconds}};
  if (r.flops > 0.0) {
    const double rate = r.flops / r.milliseconds / 1e6;
    json["flops"] = r.flops;
    json["GF_per_s"] = rate;
    json["share_of_peak"] =
        rate / (r.precision == "single" ? peak.single_GF_per_s : peak.double_GF_per_s);
  }
  if (r.bytes > 0.0) {
    const double rate = r.bytes / r.milliseconds / 1e6;
    json["bytes"] = r.bytes;
    json["GB_per_s"] = rate;
    json["share_of_bandwidth"] = rate / r.read_GB_per_s;
    json["read_GB_per_s"] = r.read_GB_per_s;
  }
  return json;
}

}  // namespace

nlohmann::ordered_json bench_roofline(const BenchOptions& options, const MachineFacts& machine) {
  const PeakRates peak = measure_peak_rates();
  fmt::print("measured peak: {:.0f} GF/s single, {:.0f} GF/s double, reads {:.1f} GB/s\n\n",
             peak.single_GF_per_s, peak.double_GF_per_s, machine.read_GB_per_s);
  nlohmann::ordered_json json{{"machine", to_json(machine)},
                              {"rows", nlohmann::ordered_json::array()}};
  json["machine"]["single_GF_per_s"] = peak.single_GF_per_s;
  json["machine"]["double_GF_per_s"] = peak.double_GF_per_s;
  for (const Grid& grid : grids) {
    const int nodes = grid.side * grid.side;
    if (options.nodes.empty() ? nodes > 30'000 : !std::ranges::count(options.nodes, nodes))
      continue;
    SceneSimulation simulation(
        read_scene(options.scenes + "/ball.toml",
                   std::vector<std::string>{fmt::format("cloth.grid.nodes=[{0},{0}]", grid.side),
                                            fmt::format("time.step={}", grid.step),
                                            "solver.name=\"core_fast\"", "time.frames=100000"}));
    std::vector<RooflineRow> rows;
    simulation.on_solved = [&](const SolveSummary&) {
      if (simulation.contact().contacts() > 0 && rows.empty()) Phases(simulation, rows).measure();
    };
    StepReport record;
    while (rows.empty())
      if (const Status status = simulation.step(record); !status.ok())
        throw InputError(status.message);
    TextTable table({"nodes", "phase", "precision", "ms", "Mflop", "MB", "GF/s", "of peak", "GB/s",
                     "of reading"});
    for (const RooflineRow& r : rows) {
      const double flop_rate = r.flops / r.milliseconds / 1e6,
                   byte_rate = r.bytes / r.milliseconds / 1e6;
      table.add(
          {std::to_string(r.nodes), r.phase, r.precision, fmt::format("{:.3f}", r.milliseconds),
           fmt::format("{:.1f}", r.flops / 1e6), fmt::format("{:.1f}", r.bytes / 1e6),
           fmt::format("{:.1f}", flop_rate),
           share(flop_rate, r.precision == "single" ? peak.single_GF_per_s : peak.double_GF_per_s),
           fmt::format("{:.1f}", byte_rate), share(byte_rate, r.read_GB_per_s)});
      json["rows"].push_back(phase_json(r, peak, machine));
    }
    fmt::print("{}\n", table.text());
    std::fflush(stdout);
  }
  fmt::print(
      "Medians of {} (CHOLMOD: 3) on the first state in contact. Bytes: what must be read or "
      "written at least; \"of reading\": of the rate at which an array of as many bytes is\nread "
      "again and again, from a cache where it fits. Flops of the factor: those of its entries, "
      "without padding.\n",
      repetitions);
  return json;
}

}  // namespace taut::app
