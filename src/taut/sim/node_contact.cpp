#include "taut/sim/node_contact.h"

#include "taut/contact/solid_contact.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/surface_contact.h"
#include "taut/step/state.h"

namespace taut {

static_assert(touches_solid == touched_solid && touches_cloth == touched_cloth);

std::vector<std::uint8_t> node_contact(const Simulation& simulation) {
  std::vector<std::uint8_t> contact(static_cast<std::size_t>(simulation.cloth().nodes()), 0);
  if (simulation.steps_done() == 0) return contact;
  if (const SurfaceContact* surface = simulation.surface_contact()) {
    const std::span<const std::uint8_t> touched = surface->contact().touched();
    for (std::size_t i = 0; i < contact.size() && i < touched.size(); ++i) contact[i] = touched[i];
    for (const Index node : surface->contact().zone_state().node) contact[node] |= held_in_zone;
  }
  for (const Index node : simulation.contact().state().node) contact[node] |= touches_solid;
  return contact;
}

}  // namespace taut
