#pragma once
// What a Snapshot holds (sim/snapshot.h): all that the steps to come depend on, beside the World
// and the SimulationOptions.
//
// As bytes: "TAUTSNP1", the fields in their order, an FNV-1a sum; little-endian.

#include "taut/contact/cloth_contact.h"
#include "taut/contact/solid_contact.h"
#include "taut/element/external.h"
#include "taut/element/spring_material.h"
#include "taut/sim/mesh_solid.h"
#include "taut/sim/pinned_nodes.h"
#include "taut/step/state.h"

namespace taut {

// Time is counted in steps of equal length, so that it does not drift: origin + since_origin h.
struct StepClock {
  int steps = 0;        // done since the start
  double origin = 0.0;  // s
  int since_origin = 0;
  double h = 0.0;        // s, of these steps; 0: none yet
  double longest = 0.0;  // s, of any step so far: the core is chosen for it
};

struct SimulationState {
  std::uint64_t world = 0;  // a sum of the world's meshes and masses
  StepClock clock;
  State state;
  ContactState contacts;
  ClothContactState surface_contact;
  std::vector<double> solver_memory;
  // What the program has set since the start.
  Vec3 gravity = Vec3::Zero();
  WindOptions wind;
  std::vector<Vec3> applied;
  std::vector<SpringMaterial> materials;  // one a cloth
  std::vector<PinnedNodes> pins;
  std::vector<Solid> solids;
  std::vector<Pose> solid_targets;                   // of solids that wait for a step to move them
  std::vector<std::uint8_t> awaits_step;             // 1: such a solid
  std::vector<MeshSolid::Deformation> deformations;  // one a solid that is a mesh
  std::vector<std::vector<Vec3>> shape_targets;      // likewise; empty: none waits
};

std::string to_bytes(const SimulationState& state);
// `name` stands in messages. Throws InputError on anything but a whole state of this version.
SimulationState state_from(std::string_view bytes, const std::string& name);

}  // namespace taut
