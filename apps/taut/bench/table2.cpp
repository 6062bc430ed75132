#include <fmt/format.h>

#include "bench/benches.h"
#include "bench/paper_tables.h"
#include "bench/table.h"
#include "taut/base/error.h"
#include "taut/linalg/sparse_cholesky.h"
#include "taut/scene/scene_file.h"
#include "taut/step/integrator.h"

namespace taut::app {

namespace {

struct Size {
  int nodes, side;
  const char* step;  // s
};
constexpr Size sizes[] = {{1681, 41, "6.67e-3"}, {6561, 81, "5.55e-3"}, {25921, 161, "3.67e-3"}};

constexpr IntegratorKind semi_implicit = IntegratorKind::semi_implicit_euler,
                         implicit_explicit = IntegratorKind::imex;

// Of the slowest methods every other step will do where a step takes seconds.
std::vector<Method> methods_of_table2(bool is_large) {
  const int every = is_large ? 2 : 1;
  const bool pardiso = make_cholesky("pardiso") != nullptr;
  std::vector<Method> methods{{"mpcg:diagonal", semi_implicit}, {"cholmod", semi_implicit}};
  methods.insert(
      methods.end(),
      {{"block_cholesky", semi_implicit}, {"core_fast", semi_implicit}, {"auto", semi_implicit}});
  if (pardiso)
    methods.insert(methods.end(),
                   {{"pardiso", semi_implicit, "vectors", every}, {"pardiso_cgs", semi_implicit}});
  methods.insert(methods.end(),
                 {{"core_pcg", semi_implicit, "vectors"}, {"core_pcg", semi_implicit, "matrix"}});
  if (pardiso) methods.push_back({"core_pcg:pardiso", semi_implicit, "vectors", every});
  methods.insert(methods.end(),
                 {{"mpcg:diagonal", implicit_explicit}, {"cholmod", implicit_explicit}});
  if (pardiso) methods.push_back({"pardiso", implicit_explicit, "vectors", every});
  return methods;
}

std::string label_of(const Cell& c) {
  return c.method.solver == "pardiso_cgs"
             ? fmt::format("pardiso_cgs ({} factorised)", c.factorisations)
             : c.method.label();
}

std::string paper_method(const Method& method) {
  return method.solver == "mpcg:diagonal" ? "mpcg" : method.solver;
}

// "#4  0.47": iterations, and the time relative to CHOLMOD's on the full matrix in the same table.
std::string against_paper(int nodes, int k, const Method& method) {
  const PaperRow* row =
      paper_row("ball", nodes, name_of(method.integrator), k, paper_method(method));
  const PaperRow* full = paper_row("ball", nodes, "semi_implicit_euler", k, "cholmod");
  if (!row || !full) return "-";
  const std::string iterations = row->iterations ? fmt::format("#{}  ", *row->iterations) : "";
  return iterations +
         (row->seconds ? fmt::format("{:.2f}", *row->seconds / *full->seconds) : "illegible");
}

void add_to(TextTable& table, const Size& size, int k, const Cell& c, const Cell& full) {
  const bool iterative = c.iterations > 0;
  table.add({fmt::format("{}", size.nodes), name_of(c.method.integrator), fmt::format("{}", k),
             label_of(c), iterative ? fmt::format("{:.1f}", c.iterations) : "-",
             c.bound_iterations >= 0 ? fmt::format("{:.0f}", c.bound_iterations) : "-",
             fmt::format("{:.2f}", c.step_ms()), fmt::format("{:.2f}", c.assemble_ms),
             fmt::format("{:.2f}", c.setup_ms), fmt::format("{:.2f}", c.solve_ms),
             fmt::format("{:.3f}", c.total_ms() / full.total_ms()),
             fmt::format("{:.3f}", c.step_ms() / full.step_ms()),
             c.equal_error_ms > 0 ? fmt::format("{:.2f}", c.equal_error_ms) : "-",
             c.equal_error_iterations > 0 ? fmt::format("{:.1f}", c.equal_error_iterations) : "-",
             fmt::format("{:.1e}", c.anorm_error), against_paper(size.nodes, k, c.method)});
}

}  // namespace

std::vector<ReportRow> bench_table2(const BenchOptions& options) {
  if (!make_cholesky("pardiso"))
    fmt::print(
        "PARDISO's columns are left out: oneMKL is not built into this program; './taut setup "
        "pardiso' fetches it.\n\n");
  std::vector<ReportRow> rows;
  for (const Size& size : sizes) {
    if (!options.nodes.empty() && !std::ranges::count(options.nodes, size.nodes)) continue;
    const bool is_large = size.nodes > 10000;
    const std::vector<Method> methods = methods_of_table2(is_large);
    TextTable table({"nodes", "matrix", "k_strh", "method", "iterations", "bound", "step ms",
                     "assembly", "set-up", "solve", "/CHOLMOD", "with asm.", "to 1e-3 ms", "its",
                     "A-error", "paper"});
    for (const int k :
         options.stiffnesses.empty() ? std::vector<int>{60, 600, 6000} : options.stiffnesses) {
      fmt::print(stderr, "table2: {} nodes at k_strh = {} ...\n", size.nodes, k);
      const std::vector<std::string> settings{fmt::format("cloth.grid.nodes=[{0},{0}]", size.side),
                                              fmt::format("time.step={}", size.step),
                                              // for the way there
                                              fmt::format("cloth.k_stretch={}", k),
                                              "solver.name=\"core_fast\""};
      SceneSimulation simulation(read_scene(options.scenes + "/ball.toml", settings));
      const auto cells = measure(
          simulation, methods,
          {options.tolerance, options.steps,
           is_large ? 4 * options.equal_error_every : options.equal_error_every, 1e-3, "cholmod"},
          [](const SceneSimulation&, const StepReport& record) { return record.contacts > 0; });
      const auto full = std::ranges::find_if(cells, [](const Cell& c) {
        return c.method.solver == "cholmod" && c.method.integrator == semi_implicit;
      });
      const SpringMaterial& material = simulation.scene().cloths[0].material;
      for (const Cell& c : cells) {
        rows.push_back({"ball", size.nodes, double(k), material.k_shear, material.k_bend,
                        simulation.scene().time.step, c});
        add_to(table, size, k, c, *full);
      }
      table.add_rule();
    }
    fmt::print("{}\n", table.text());
    std::fflush(stdout);
  }
  fmt::print(
      "Each row: mean over {} steps after the first contact, all methods on the same states (of "
      "the semi-implicit run). /CHOLMOD: set-up "
      "and solve relative to CHOLMOD on the\n"
      "full matrix; \"with asm.\": both with assembly, as the paper counts. \"to 1e-3\": time and "
      "iterations to an A-norm error of 1e-3 in "
      "the reduced unknowns.\n"
      "A-error: at the paper's stop rule with tol = {:g}. paper: iterations and time relative to "
      "its CHOLMOD on the full matrix.\n"
      "pardiso: analysis, factorisation and solve in each step (with 25,921 nodes it is measured "
      "in every other one); pardiso_cgs: its CG "
      "on the factor of an earlier step, \"factorised\": the "
      "steps in which that was not\n"
      "possible (other constraints, or CG given up).\n",
      options.steps, options.tolerance);
  return rows;
}

}  // namespace taut::app
