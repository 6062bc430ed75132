#pragma once
// Measuring linear solvers on the states of a running simulation.
//
// A simulation (semi-implicit Euler) runs to the first step of interest. From there on, in each of
// `steps` steps, every method solves the same system: same state, same constraints, same friction
// impulses, same initial guess. Cells are means over these steps; ratios are medians of the steps'
// own ratios, so that a drifting machine speed cancels.

#include <functional>
#include <string>
#include <vector>

#include "taut/scene/scene_simulation.h"

namespace taut::app {

struct Method {
  std::string solver;
  IntegratorKind integrator = IntegratorKind::semi_implicit_euler;
  std::string reordering = "vectors";
  int every = 1;  // measured in every so many steps
  std::string label() const {
    return reordering == "matrix" ? solver + " (matrix reordered)" : solver;
  }
};

// Means over the measured steps.
struct Cell {
  Method method;
  int steps = 0;
  double iterations = 0.0, bound_iterations = -1.0;
  // setup: reduction, ordering, factorisation
  double assemble_ms = 0.0, setup_ms = 0.0, solve_ms = 0.0;
  double total_ms() const { return setup_ms + solve_ms; }
  // as the paper counts: assembly included
  double step_ms() const { return assemble_ms + total_ms(); }
  // median over the steps of total_ms / that of the reference method; 0: no reference
  double ratio = 0.0;
  double step_ratio = 0.0;  // the same with assembly
  double relative_residual = 0.0, anorm_error = 0.0;
  // total to A-norm error 1e-3, mean of the steps where it was measured; 0: not measured
  double equal_error_ms = 0.0;
  double equal_error_iterations = 0.0;
  double equal_error_ratio = 0.0;
  double memory_MB = 0.0;
  double spmv_ms = 0.0;
  double nonzeros = 0.0;  // of the (reduced) matrix
  int failures = 0;
  std::string precision = "double";  // of the last step
  int fallbacks = 0;                 // from single to double precision, all steps
  // pardiso_cgs: steps in which CG on the kept factor was not possible, or given up
  int factorisations = 0;
  Index unknowns = 0, held_nodes = 0;
};

struct MeasureOptions {
  double tolerance = 1e-3;
  int steps = 20;
  // measure the time to A-norm error 1e-3 in every so many steps; 0: never
  int equal_error_every = 5;
  double equal_error = 1e-3;
  std::string reference = "cholmod";  // of the same integrator
};

// `start` says whether the coming steps are to be measured; it is asked after each step until it is
// true. Returns one cell a method. Throws InputError when the simulation fails or `start` never
// comes true.
std::vector<Cell> measure(
    SceneSimulation& simulation, const std::vector<Method>& methods, const MeasureOptions& options,
    const std::function<bool(const SceneSimulation&, const StepReport&)>& start);

}  // namespace taut::app
