#include <fmt/format.h>

#include <cmath>

#include "bench/benches.h"
#include "bench/paper_tables.h"
#include "bench/table.h"
#include "taut/scene/scene_file.h"
#include "taut/sim/cloth_model.h"
#include "taut/step/state.h"

namespace taut::app {

namespace {

struct Experiment {
  const char* paper_name;
  const char* file;
  // Whether the states from here on are those to measure.
  bool (*start)(const SceneSimulation&, const StepReport&);
};

bool swings(const SceneSimulation& simulation, const StepReport&) {
  return simulation.state().time >= 0.3;
}

// What has come to lie on the sphere lies there by then, held by friction or sliding.
bool lies(const SceneSimulation& simulation, const StepReport&) {
  return simulation.state().time >= 0.9;
}

const Experiment experiments[] = {{"pinned", "pinned.toml", swings},
                                  {"draping", "drape.toml", lies}};

std::vector<std::string> settings_of(int nodes, int k_stretch) {
  return {fmt::format("cloth.grid.nodes=[{0},{0}]", std::lround(std::sqrt(nodes))),
          "time.step=3.67e-3", fmt::format("cloth.k_stretch={}", k_stretch), "time.frames=100000",
          "solver.name=\"core_fast\""};  // for the way there; what is measured is told apart
}

std::string against_paper(const char* scene, int nodes, int k, const std::string& method) {
  const PaperRow* row = paper_row(scene, nodes, "semi_implicit_euler", k, method);
  return row ? fmt::format("#{}  {:.2f} s", *row->iterations, *row->seconds) : "-";
}

// The paper's size is 6,561 nodes.
std::vector<std::pair<Experiment, int>> wanted(const BenchOptions& options) {
  std::vector<std::pair<Experiment, int>> list;
  for (const int nodes : options.nodes.empty() ? std::vector<int>{6561} : options.nodes)
    for (const Experiment& experiment : experiments) list.emplace_back(experiment, nodes);
  return list;
}

}  // namespace

std::vector<ReportRow> bench_table1(const BenchOptions& options) {
  const std::vector<Method> methods{
      {"mpcg:diagonal"}, {"upcg:diagonal"}, {"upcg:reduced_diagonal"}, {"cholmod"}};
  std::vector<ReportRow> rows;
  for (const auto& [experiment, nodes] : wanted(options)) {
    TextTable table({"scene", "k_strh", "method", "iterations", "step ms", "assembly", "set-up",
                     "loop", "us/iteration", "vs MPCG", "per it.", "nonzeros", "paper"});
    for (const int k :
         options.stiffnesses.empty() ? std::vector<int>{60, 600, 6000} : options.stiffnesses) {
      fmt::print(stderr, "table1: {}, {} nodes at k_strh = {} ...\n", experiment.paper_name, nodes,
                 k);
      SceneSimulation simulation(
          read_scene(options.scenes + "/" + experiment.file, settings_of(nodes, k)));
      const auto cells =
          measure(simulation, methods, {options.tolerance, options.steps, 0, 1e-3, "cholmod"},
                  experiment.start);
      const Cell& mpcg = cells.front();
      const SpringMaterial& material = simulation.scene().cloths[0].material;
      for (const Cell& c : cells) {
        rows.push_back({experiment.paper_name, simulation.cloth().nodes(), double(k),
                        material.k_shear, material.k_bend, simulation.scene().time.step, c});
        const bool iterative = c.iterations > 0;
        const auto per_iteration = [](const Cell& cell) {
          return 1000.0 * cell.solve_ms / std::max(1.0, cell.iterations);
        };
        table.add({experiment.paper_name, fmt::format("{}", k), c.method.solver,
                   fmt::format("{:.1f}", c.iterations), fmt::format("{:.1f}", c.step_ms()),
                   fmt::format("{:.1f}", c.assemble_ms), fmt::format("{:.1f}", c.setup_ms),
                   fmt::format("{:.1f}", c.solve_ms),
                   iterative ? fmt::format("{:.0f}", per_iteration(c)) : "-",
                   fmt::format("{:.2f}", c.step_ms() / mpcg.step_ms()),
                   iterative ? fmt::format("{:.2f}", per_iteration(c) / per_iteration(mpcg)) : "-",
                   iterative ? fmt::format("{:.2f}", c.nonzeros / mpcg.nonzeros) : "-",
                   against_paper(experiment.paper_name, nodes, k,
                                 c.method.solver == "mpcg:diagonal"   ? "mpcg"
                                 : c.method.solver == "upcg:diagonal" ? "upcg"
                                                                      : "")});
      }
      table.add_rule();
      fmt::print(stderr, "  {} unknowns, {} of {} nodes held\n", mpcg.unknowns, mpcg.held_nodes,
                 simulation.cloth().nodes());
    }
    fmt::print("{}\n", table.text());
  }
  fmt::print(
      "Each row: mean over {} steps, all methods on the same states. step = assembly + set-up + "
      "loop. \"vs MPCG\": ratio of step times; "
      "\"per it.\": of the\n"
      "loops' time an iteration; \"nonzeros\": of the matrices' nonzeros. paper: Table 1 "
      "(iterations, seconds a step, its own machine).\n",
      options.steps);
  return rows;
}

}  // namespace taut::app
