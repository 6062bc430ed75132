#pragma once
// What a Simulation is made of (sim/simulation.h).

#include "taut/contact/solid_contact.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/simulation.h"
#include "taut/sim/simulation_state.h"
#include "taut/sim/surface_contact.h"
#include "taut/solve/fallback.h"
#include "taut/step/stepper.h"

namespace taut {

struct Simulation::Parts {
  // Both are valid.
  Parts(World world, SimulationOptions options);

  World world;
  SimulationOptions options;
  ClothModel cloth;
  std::vector<int> variant_of;  // which of the world's solids each of contact_'s is
  SolidContact contact;
  std::unique_ptr<SurfaceContact> surface_contact;
  std::unique_ptr<Stepper> stepper;
  FallbackChain fallback;
  ConstraintSet pins, held, constraints;  // held: pins and zones
  State state;
  SolveSummary last_summary;
  StepClock clock;
  // Solids that wait for the next step to move them, one entry a solid of the world.
  std::vector<Pose> solid_targets;
  std::vector<std::uint8_t> awaits_step;
  std::vector<std::vector<Vec3>> shape_targets;
};

}  // namespace taut
