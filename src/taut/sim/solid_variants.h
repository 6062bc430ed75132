#pragma once
// The scene's solids as contact takes them (contact/solid_contact.h): a solid that has another
// thickness or friction with some cloth (ContactPair) stands there twice, once for that cloth's
// nodes and once for all others.

#include "taut/scene/cloth_model.h"

namespace taut {

struct SolidVariants {
  std::vector<Solid> solids;
  // one list a solid: 1 at the nodes that it is for; empty: all
  std::vector<std::vector<std::uint8_t>> meets;
};

SolidVariants solid_variants(const Scene& scene, const ClothModel& cloth);

}  // namespace taut
