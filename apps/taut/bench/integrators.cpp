// taut bench integrators: how far each integrator ends from the exact motion, and what it costs
// (paper, Sections 5 and 6: thin matrices against full ones).
//
// The exact motion is implicit Euler solved by Newton's method at 1/8 and 1/16 of the longest step,
// extrapolated: 2 x_(h/16) - x_(h/8). Steps are not halved, and the linear systems are solved to
// 1e-6, so that nothing but the integrator differs.

#include <fmt/format.h>

#include <cmath>

#include "bench/benches.h"
#include "bench/table.h"
#include "taut/base/timer.h"
#include "taut/scene/scene_file.h"
#include "taut/step/state.h"
#include "taut/step/stepper.h"

namespace taut::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* scene_names[] = {"pinned", "ball"};
constexpr IntegratorKind integrators[] = {IntegratorKind::semi_implicit_euler, IntegratorKind::imex,
                                          IntegratorKind::imex_adaptive, IntegratorKind::bdf2,
                                          IntegratorKind::newton};
constexpr double longest_step = 6.67e-3;  // s; the paper's at 1,681 nodes
constexpr int longest_steps = 60;
constexpr int refinements[] = {1, 2, 4};
constexpr int reference_refinements[] = {8, 16};
constexpr double lost = 1e3;  // m

struct Motion {
  std::vector<Vec3> x;
  double seconds = 0.0, worst_stretch = 0.0;
  int steps = 0, solves = 0;
  std::string failure;  // why it ended early
};

class Integrators {
 public:
  explicit Integrators(const BenchOptions& options)
      : options_(options), side_(options.nodes.empty() ? 41 : side_of(options.nodes.front())) {}

  Json run() {
    for (const char* scene : scene_names)
      for (const int k :
           options_.stiffnesses.empty() ? std::vector<int>{60, 6000} : options_.stiffnesses)
        measure(scene, k);
    fmt::print(
        "{}\nrms, max: distance of the nodes from the exact motion at the end, {:.3f} s, in mm; "
        "ms: of a step; stretch: the largest of any "
        "spring at any time.\n",
        table_.text(), longest_steps * longest_step);
    return std::move(rows_);
  }

 private:
  Motion simulate(const std::string& scene, int k, IntegratorKind kind, int refinement) const {
    const std::vector<std::string> settings{
        fmt::format("cloth.grid.nodes=[{0},{0}]", side_),
        fmt::format("cloth.k_stretch={}", k),
        "cloth.compression=linear",
        fmt::format("time.step={:.17g}", longest_step / refinement),
        "time.frames=100000",
        "time.max_halvings=0",
        fmt::format("time.integrator={}", name_of(kind)),
        "solver.name=core_fast",
        "solver.tolerance=1e-6"};
    SceneSimulation simulation(
        read_scene(fmt::format("{}/{}.toml", options_.scenes, scene), settings));
    Motion motion;
    StepReport record;
    const Timer timer;
    for (int step = 0; step < longest_steps * refinement && motion.failure.empty(); ++step) {
      const Status status = simulation.step(record);
      ++motion.steps;
      motion.solves += record.contact_passes + record.newton_iterations;
      motion.worst_stretch = std::max(motion.worst_stretch, record.max_stretch);
      if (!status.ok()) motion.failure = status.message;
      if (!(simulation.state().x[0].norm() < lost && record.max_stretch < lost))
        motion.failure = "blown up";
    }
    motion.seconds = 1e-3 * timer.milliseconds();
    motion.x = simulation.state().x;
    return motion;
  }

  void measure(const std::string& scene, int k) {
    fmt::print(stderr, "integrators: {} at k_stretch = {}: the exact motion ...\n", scene, k);
    const Motion coarse = simulate(scene, k, IntegratorKind::newton, reference_refinements[0]);
    const Motion fine = simulate(scene, k, IntegratorKind::newton, reference_refinements[1]);
    std::vector<Vec3> exact(fine.x.size());
    for (std::size_t i = 0; i < exact.size(); ++i) exact[i] = 2.0 * fine.x[i] - coarse.x[i];
    for (const IntegratorKind kind : integrators)
      for (const int refinement : refinements) {
        fmt::print(stderr, "integrators:   {}, h/{}\n", name_of(kind), refinement);
        add(scene, k, kind, refinement, simulate(scene, k, kind, refinement), exact);
      }
    add(scene, k, IntegratorKind::newton, reference_refinements[1], fine, exact);
    table_.add_rule();
  }

  void add(const std::string& scene, int k, IntegratorKind kind, int refinement,
           const Motion& motion, const std::vector<Vec3>& exact) {
    double sum = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double distance2 = (motion.x[i] - exact[i]).squaredNorm();
      sum += distance2, largest = std::max(largest, std::sqrt(distance2));
    }
    const double rms = std::sqrt(sum / static_cast<double>(exact.size())),
                 h = longest_step / refinement;
    Json row{{"solver", "core_fast"},       {"scene", scene},
             {"nodes", side_ * side_},      {"k_stretch", k},
             {"integrator", name_of(kind)}, {"h", h},
             {"steps", motion.steps},       {"solves", motion.solves},
             {"seconds", motion.seconds},   {"worst_stretch", motion.worst_stretch}};
    if (motion.failure.empty()) {
      row["rms_m"] = rms, row["max_m"] = largest;
    } else {
      row["failure"] = motion.failure;
    }
    rows_.push_back(std::move(row));
    const bool ok = motion.failure.empty();
    table_.add({scene, fmt::format("{}", k), name_of(kind), fmt::format("{:.2f}", 1e3 * h),
                fmt::format("{:.1f}", 1e3 * motion.seconds / motion.steps),
                fmt::format("{:.1f}", static_cast<double>(motion.solves) / motion.steps),
                ok ? fmt::format("{:.2f}", 1e3 * rms) : "-",
                ok ? fmt::format("{:.1f}", 1e3 * largest) : "-",
                fmt::format("{:.1f} %", 1e2 * motion.worst_stretch), motion.failure});
  }

  BenchOptions options_;
  int side_;
  TextTable table_{{"scene", "k_strh", "integrator", "h ms", "ms", "solves", "rms mm", "max mm",
                    "stretch", "remark"}};
  Json rows_ = Json::array();
};

}  // namespace

Json bench_integrators(const BenchOptions& options) { return Integrators(options).run(); }

}  // namespace taut::app
