#pragma once
// What one step did: the outcome and a row of stats.csv (docs/results.md has the columns).

#include <string>

#include "taut/base/status.h"
#include "taut/base/types.h"

namespace taut {

// Times in ms; of several contact passes, times are sums and the solver's
// numbers are the largest.
struct StepReport {
  Status status;  // not ok: nothing has changed, time and state are those before the step
  bool ok() const { return status.ok(); }
  const std::string& message() const { return status.message; }

  int step = 0;
  double time = 0.0;  // s, at the end of the step
  Index nodes = 0, dof = 0, constraints = 0;
  int contacts = 0;
  std::string solver;
  Index core_springs = 0;  // 0 when the solver has no core
  int iterations = 0;
  double relative_residual = 0.0;
  double assemble_ms = 0.0, order_ms = 0.0, factor_ms = 0.0, solve_ms = 0.0, contact_ms = 0.0,
         step_ms = 0.0;
  double kinetic_J = 0.0, elastic_J = 0.0;
  double max_stretch = 0.0;   // largest L/L0 - 1 of all stretch springs
  int bound_iterations = -1;  // -1: the solver, of several passes one of them, has no bound
  int fallbacks = 0;
  std::string precision = "double";  // of the factor; of several passes the higher one
  Index collapsed_springs = 0;
  int contact_passes = 0;
  int newton_iterations = 0;  // linear solves beyond one a pass; nonlinear integrators
  // the largest that was accepted after the last halving, share of a rest length; 0: none
  double overshoot = 0.0;
  // times that the step, or a part of it, was redone with half the length
  int retries = 0;
  int contact_moved = 0;   // nodes moved out of solids after the last pass
  double deepest_m = 0.0;  // how deep the deepest of them was
  // Cloth with cloth and mesh solids (contact/cloth_contact.h); of a step in parts, sums, of zones
  // the largest.
  Offset pairs_tested = 0;
  int near_pairs = 0, pushing_pairs = 0, impacts = 0, zones = 0, zone_nodes = 0, largest_zone = 0;
  double near_ms = 0.0, impulse_ms = 0.0, detect_ms = 0.0, zone_ms = 0.0, check_ms = 0.0;
  int intersections = -1;  // -1: not looked for
};

}  // namespace taut
