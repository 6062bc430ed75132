// taut bench scale: time and memory against the number of nodes, and the exponents.
//
// The ball touches the sheet from the start, so that a few steps suffice at a million nodes. Mass
// of a node, stiffnesses and step are those of the paper's largest sheet at every size: what
// changes is the size. The answer is known at every size without a direct solve: x* is what the
// step's own solver found, and b is replaced by A x*, whose exact answer x* is; cloth-cloth contact
// is not looked for, because the matrix does not depend on it. A time is also given in products
// with A, which grow with the size alone.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "bench/benches.h"
#include "bench/equal_error.h"
#include "bench/median.h"
#include "bench/table.h"
#include "taut/base/error.h"
#include "taut/scene/scene_file.h"
#include "taut/sim/simulation_state.h"
#include "taut/solve/linear_system.h"
#include "taut/step/state.h"
#include "taut/step/stepper.h"

namespace taut::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr int all_sides[] = {41, 81, 161, 321, 641, 1001};
constexpr int default_sides = 4;

struct Sample {
  double nodes, ms, memory_MB;
};

// Of what a new program may take without swapping; 0 when the system does not say.
double available_MB() {
  std::ifstream meminfo("/proc/meminfo");
  for (std::string line; std::getline(meminfo, line);)
    if (line.starts_with("MemAvailable:")) return std::stod(line.substr(13)) / 1024.0;
  return 0.0;
}

// Slope of log(value) over log(nodes), least squares; NaN with fewer than two samples.
double exponent(const std::vector<Sample>& samples, double Sample::* value) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Sample& sample : samples) {
    if (!(sample.*value > 0.0)) continue;
    const double x = std::log(sample.nodes), y = std::log(sample.*value);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return n < 2 ? NAN : (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

std::string exponent_text(double value) {
  return std::isfinite(value) ? fmt::format("n^{:.2f}", value) : "-";
}

// Of a square grid of another size, bilinearly.
std::vector<Vec3> interpolated(const std::vector<Vec3>& values, int from, int to) {
  std::vector<Vec3> result;
  const double scale = static_cast<double>(from - 1) / (to - 1);
  const auto cell = [&](int k) { return std::min(static_cast<int>(k * scale), from - 2); };
  const auto value = [&](int i, int j) { return values[static_cast<std::size_t>(j * from + i)]; };
  for (int j = 0; j < to; ++j)
    for (int i = 0; i < to; ++i) {
      const int ci = cell(i), cj = cell(j);
      const double s = i * scale - ci, t = j * scale - cj;
      result.push_back((1 - t) * ((1 - s) * value(ci, cj) + s * value(ci + 1, cj)) +
                       t * ((1 - s) * value(ci, cj + 1) + s * value(ci + 1, cj + 1)));
    }
  return result;
}

State interpolated(const State& state, int from, int to) {
  State result;
  result.time = state.time;
  result.x = interpolated(state.x, from, to), result.v = interpolated(state.v, from, to);
  return result;
}

class Scale {
 public:
  explicit Scale(const BenchOptions& options)
      : options_(options),
        methods_(methods_of(options)),
        table_({"nodes", "method", "to 1e-3 ms", "in products", "to 1e-6 ms", "set-up", "memory MB",
                "A-error", "remark"}) {}

  Json run() {
    std::vector<int> sizes = options_.nodes;
    if (sizes.empty())
      for (const int side :
           std::span(all_sides).first(options_.full ? std::size(all_sides) : default_sides))
        sizes.push_back(side * side);
    for (const int nodes : sizes) side_of(nodes);
    fmt::print(stderr, "scale: {} nodes into contact ...\n", start_side * start_side);
    coarse_ = std::make_unique<SceneSimulation>(sheet(start_side));
    run_into_contact(*coarse_, 12);
    for (const int nodes : sizes) measure_size(side_of(nodes));
    fmt::print("{}\n", table_.text());
    print_exponents();
    return std::move(rows_);
  }

 private:
  static constexpr int start_side = 41, own_steps = 2;

  Scene sheet(int side) const {
    const std::vector<std::string> settings{fmt::format("cloth.grid.nodes=[{0},{0}]", side),
                                            "cloth.k_stretch=6000", "time.step=3.67e-3",
                                            "time.frames=100000", "contact.self=false",
                                            // The answer of the step is the reference: it must be
                                            // better than what is measured against it.
                                            "solver.name=core_fast", "solver.tolerance=1e-9"};
    return read_scene(options_.scenes + "/ball.toml", settings);
  }

  void measure_size(int side) {
    const int nodes = side * side;
    fmt::print(stderr, "scale: {} nodes ...\n", nodes);
    SceneSimulation simulation(sheet(side));
    SimulationState start = simulation.full_state();
    start.state = interpolated(coarse_->state(), start_side, side);
    start.clock.steps = start.clock.since_origin = coarse_->steps_done();
    start.clock.h = simulation.scene().time.step;
    simulation.set_full_state(start);
    StepReport record;
    for (int step = 0; step < own_steps; ++step)
      if (const Status status = simulation.step(record); !status.ok())
        throw InputError(status.message);
    bool measured = false;
    simulation.on_solved = [&](const SolveSummary&) {
      if (!measured) measure_system(simulation, nodes);
      measured = true;
    };
    simulation.step(record);
  }

  void measure_system(SceneSimulation& simulation, int nodes) {
    LinearSystem system = simulation.stepper().system();
    const auto answer = flat(simulation.stepper().unknown());
    const std::vector<double> reference(answer.begin(), answer.end());
    std::vector<double> rhs(reference.size());
    multiply(*system.matrix, reference, rhs);
    system.rhs = rhs;
    system.guess = {};
    std::vector<double> product(reference.size());
    product_ms_ = median_ms([&] { multiply(*system.matrix, reference, product); });
    const SpringMaterial& material = simulation.scene().cloths[0].material;
    for (const std::string& method : methods_) {
      Json row{{"scene", "ball"},
               {"nodes", nodes},
               {"k_stretch", material.k_stretch},
               {"k_shear", material.k_shear},
               {"k_bend", material.k_bend},
               {"h", simulation.scene().time.step},
               {"integrator", "semi_implicit_euler"}};
      if (const std::string reason = too_much(method, nodes); !reason.empty()) {
        table_.add({fmt::format("{}", nodes), method, "-", "-", "-", "-", "-", "-", reason});
        continue;
      }
      fmt::print(stderr, "scale:   {}\n", method);
      const EqualErrorResult result =
          measure_equal_error(system, method, reference, options_.seconds_limit);
      put(row, result);
      row["product_ms"] = product_ms_;
      rows_.push_back(std::move(row));
      note(nodes, result);
    }
    table_.add_rule();
  }

  // What the sizes so far let expect, so that a bench neither swaps nor runs for hours: the reason
  // to leave a method out, or nothing.
  std::string too_much(const std::string& method, double nodes) const {
    const auto found = samples_.find(method);
    if (found == samples_.end() || found->second.empty()) return "";
    const Sample& last = found->second.back();
    const double memory = last.memory_MB * std::pow(nodes / last.nodes, 1.25),
                 seconds = 1e-3 * last.ms * std::pow(nodes / last.nodes, 1.5);
    if (const double room = available_MB(); room > 0.0 && memory > 0.7 * room)
      return fmt::format("left out: would take about {:.0f} GB", memory / 1000.0);
    if (seconds > options_.seconds_limit)
      return fmt::format("left out: would take about {:.0f} s", seconds);
    return "";
  }

  void note(int nodes, const EqualErrorResult& result) {
    samples_[result.solver].push_back(
        {double(nodes), result.to[0].ms, result.summary.memory_bytes / 1e6});
    table_.add({fmt::format("{}", nodes), result.solver, text_of(result.to[0]),
                result.to[0].reached() ? fmt::format("{:.0f}", result.to[0].ms / product_ms_) : "-",
                text_of(result.to[1]),
                fmt::format("{:.1f}", result.summary.total_ms() - result.summary.solve_ms),
                fmt::format("{:.1f}", result.summary.memory_bytes / 1e6),
                result.anorm_error >= 0 ? fmt::format("{:.1e}", result.anorm_error) : "-",
                result.status.message});
  }

  void print_exponents() const {
    TextTable table({"method", "time to 1e-3", "memory"});
    for (const std::string& method : methods_)
      if (const auto found = samples_.find(method); found != samples_.end())
        table.add({method, exponent_text(exponent(found->second, &Sample::ms)),
                   exponent_text(exponent(found->second, &Sample::memory_MB))});
    fmt::print(
        "Fitted over all sizes (n nodes):\n{}\nTimes: ms (#iterations), set-up included; the first "
        "also in products A x. Mass of a node, stiffnesses and step are the same "
        "at all sizes.\n",
        table.text());
  }

  BenchOptions options_;
  std::vector<std::string> methods_;
  TextTable table_;
  std::map<std::string, std::vector<Sample>> samples_;
  std::unique_ptr<SceneSimulation> coarse_;
  double product_ms_ = 0.0;  // with the matrix at hand
  Json rows_ = Json::array();
};

}  // namespace

Json bench_scale(const BenchOptions& options) { return Scale(options).run(); }

}  // namespace taut::app
