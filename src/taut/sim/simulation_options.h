#pragma once
// How a World is stepped. Ranges: sim/describe.h; judged when a Simulation is made.

#include "taut/solve/solver_options.h"
#include "taut/step/integrator_options.h"

namespace taut {

struct SimulationOptions {
  SolverOptions solver{.name = "auto"};
  IntegratorKind integrator = IntegratorKind::semi_implicit_euler;
  NewtonOptions newton;
  // share of a spring's rest length, element/overshoot.h; beyond it a step is redone as two halves
  double overshoot_limit = 0.05;
  int max_halvings = 4;
  bool operator==(const SimulationOptions&) const = default;
};

}  // namespace taut
