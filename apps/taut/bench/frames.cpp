// taut bench frames: does the choice of U matter? (paper, Section 3: "improper U causes an
// increment of the conditional number of Ã")
//
// Any two orthonormal U of the same free directions differ by a rotation per node, so Ã's
// eigenvalues are the same, and so is everything made of whole node blocks. Preconditioners that
// look at single rows see the difference. A state without friction, in which the touched nodes have
// two free directions each, is solved with the same constraints in three kinds of frames.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "bench/benches.h"
#include "bench/table.h"
#include "taut/linalg/lanczos.h"
#include "taut/scene/scene_file.h"
#include "taut/sim/cloth_model.h"
#include "taut/solve/linear_system.h"
#include "taut/step/stepper.h"

namespace taut::app {

namespace {

using Json = nlohmann::ordered_json;

struct FrameKind {
  const char* name;
  std::array<Vec3, 2> (*complement)(const Vec3& n, Index node);
};

// Duff's pair, turned by an angle that no neighbour shares.
std::array<Vec3, 2> turned(const Vec3& n, Index node) {
  constexpr double golden_angle = 2.399963229728653;
  const Eigen::AngleAxisd turn(golden_angle * node, n);
  const auto [u1, u2] = orthonormal_complement(n);
  return {turn * u1, turn * u2};
}

const FrameKind kinds[] = {
    {"duff", [](const Vec3& n, Index) { return orthonormal_complement(n, FrameChoice::duff); }},
    {"paper_eq13",
     [](const Vec3& n, Index) { return orthonormal_complement(n, FrameChoice::paper_eq13); }},
    {"arbitrary", turned},
};
constexpr const char* methods[] = {"upcg:diagonal",
                                   "upcg:projected_block_diagonal",
                                   "upcg:reduced_diagonal",
                                   "upcg:ssor",
                                   "upcg:ic0",
                                   "core_pcg"};
struct FrameRun {
  const char* scene;
  int steps_in_contact;
};
constexpr FrameRun frame_runs[] = {{"ball", 20}, {"drape", 80}};

ConstraintSet in_frames(const ConstraintSet& constraints, const FrameKind& kind) {
  ConstraintSet result = constraints;
  for (Index i = 0; i < constraints.nodes(); ++i) {
    if (constraints.ndof(i) != 2) continue;
    const Vec3 n = constraints.frame(i).col(2);
    const auto [u1, u2] = kind.complement(n, i);
    Mat3 frame;
    frame << u1, u2, n;
    result.set_frame(i, 2, frame);
  }
  return result;
}

void measure(const FrameRun& experiment, const BenchOptions& options, Json& rows) {
  SceneSimulation simulation(
      read_scene(fmt::format("{}/{}.toml", options.scenes, experiment.scene),
                 std::vector<std::string>{"solid.0.friction=0", "solver.name=core_fast",
                                          "time.frames=100000"}));
  run_into_contact(simulation, experiment.steps_in_contact);
  TextTable table({"method", "U", "iterations", "cond(M^-1 A~)"});
  Index sliding = 0;
  simulation.on_solved = [&](const SolveSummary&) {
    LinearSystem system = simulation.stepper().system();
    const ConstraintSet original = *system.constraints;
    sliding = static_cast<Index>(std::ranges::count(original.ndofs(), std::int8_t{2}));
    system.guess = {};
    for (const char* method : methods) {
      for (const FrameKind& kind : kinds) {
        const ConstraintSet constraints = in_frames(original, kind);
        system.constraints = &constraints;
        const auto solver = make_solver({.name = method, .tolerance = options.tolerance});
        CgCoefficients coefficients;
        solver->coefficients = &coefficients;
        std::vector<double> x(system.rhs.size());
        const SolveSummary summary = solver->solve(system, x);
        const SpectrumEnds ends = spectrum_ends(coefficients);
        table.add({method, kind.name, fmt::format("{}", summary.iterations),
                   fmt::format("{:.3g}", ends.largest / ends.smallest)});
        rows.push_back({{"scene", experiment.scene},
                        {"nodes", simulation.cloth().nodes()},
                        {"solver", method},
                        {"frames", kind.name},
                        {"iterations", summary.iterations},
                        {"cond", ends.largest / ends.smallest}});
      }
      table.add_rule();
    }
  };
  StepReport record;
  simulation.step(record);
  fmt::print(
      "{}\n{}: {} nodes, {} of them with two free directions; tolerance {:g}. The condition is "
      "what Lanczos saw in these iterations.\n\n",
      table.text(), experiment.scene, simulation.cloth().nodes(), sliding, options.tolerance);
}

}  // namespace

Json bench_frames(const BenchOptions& options) {
  Json rows = Json::array();
  for (const FrameRun& experiment : frame_runs) measure(experiment, options, rows);
  return rows;
}

}  // namespace taut::app
