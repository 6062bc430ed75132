#pragma once
// The benches of `taut bench`. Each prints its table as it goes and returns its rows.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/report.h"
#include "shipped.h"

namespace taut::app {

struct BenchOptions {
  std::string scenes = scenes_folder();  // folder of ball.toml, pinned.toml, drape.toml
  int steps = 20;
  double tolerance = 1e-3;
  std::vector<int> nodes;        // table2: 1681, 6561, 25921; empty: all
  std::vector<int> stiffnesses;  // 60, 600, 6000; empty: all
  int equal_error_every = 5;
  // flatness and scale
  bool full = false;
  std::vector<std::string> methods;  // empty: those worth comparing that this build has
  double seconds_limit = 20.0;       // after which an iterative method is given up
  // contact
  int stress = -1;          // jittered copies of each scene; negative: measure times instead
  int stress_frames = 200;  // of each, whatever the scene says
  std::string judge;        // program that judges each frame's surface; empty: none
};

// Paper, Table 1: MPCG against uPCG on few and on many constraints, 6,561 nodes, h = 3.67 ms.
std::vector<ReportRow> bench_table1(const BenchOptions& options);
// Paper, Table 2: a ball hits a sheet; MPCG, CHOLMOD, PARDISO (where built in) and corePCG for
// three sizes and stiffnesses, semi-implicit Euler and IMEX matrices.
std::vector<ReportRow> bench_table2(const BenchOptions& options);
// Time to equal error over stiffness, step, shear and bend; the core's bound beside its eigenvalues
// and iterations.
nlohmann::ordered_json bench_flatness(const BenchOptions& options);
// Time to equal error and memory over the number of nodes.
nlohmann::ordered_json bench_scale(const BenchOptions& options);
// Distance from the exact motion and time of each integrator over the step, 1,681 nodes.
nlohmann::ordered_json bench_integrators(const BenchOptions& options);
// The paper's "improper U": iterations of one system in three kinds of frames, 6,561 nodes.
nlohmann::ordered_json bench_frames(const BenchOptions& options);

// Contact by phase, on ball and clump; or the stress test. Rows: one a step, or one a trial.
// `methods` then names the scenes.
nlohmann::ordered_json bench_contact(const BenchOptions& options);

// Of flatness and scale: options.methods, or the default ones that this build knows.
std::vector<std::string> methods_of(const BenchOptions& options);
// Nodes along each side of a square sheet. Throws InputError when there is no such whole number.
int side_of(int nodes);
// Steps until the first contact, then `more` of them. Throws InputError when a step fails or there
// is no contact in 1000 steps.
void run_into_contact(SceneSimulation& simulation, int more);

// One phase of a step, measured alone.
struct RooflineRow {
  Index nodes = 0;
  std::string phase, precision;
  double flops = 0.0, bytes = 0.0;  // 0: not counted
  double milliseconds = 0.0;
  double read_GB_per_s = 0.0;  // of an array of as many bytes
};
// Each phase's rate against what the machine can do at best. `options.nodes`: 1681, 6561, 25921,
// 103041 or 263169; empty: the first three.
nlohmann::ordered_json bench_roofline(const BenchOptions& options, const MachineFacts& machine);

}  // namespace taut::app
