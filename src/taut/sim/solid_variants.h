#pragma once
// The world's solids as contact takes them (contact/solid_contact.h): a solid that has another
// thickness or friction with some cloth (ContactPair) stands there twice, once for that cloth's
// nodes and once for all others.

#include "taut/sim/cloth_model.h"

namespace taut {

struct SolidVariants {
  std::vector<Solid> solids;
  // one list a solid: 1 at the nodes that it is for; empty: all
  std::vector<std::vector<std::uint8_t>> meets;
  std::vector<int> of;  // which of the world's solids each is
};

SolidVariants solid_variants(const World& world, const ClothModel& cloth);

}  // namespace taut
