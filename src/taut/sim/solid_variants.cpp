#include "taut/sim/solid_variants.h"

#include <algorithm>

namespace taut {

SolidVariants solid_variants(const World& world, const ClothModel& cloth) {
  SolidVariants result;
  for (int k = 0; k < static_cast<int>(world.solids().size()); ++k) {
    const Solid& solid = world.solids()[static_cast<std::size_t>(k)];
    const std::size_t general = result.solids.size();
    result.solids.push_back(solid);
    result.meets.emplace_back();
    result.of.push_back(k);
    // Meshes are part of the collision surface, which has its own table (contact/pair_laws.h).
    if (solid.shape == SolidShape::mesh) continue;
    for (const ContactPair& pair : world.contact.pairs) {
      const auto part = std::ranges::find(cloth.parts(), pair.cloth, &ClothPart::name);
      if (pair.with != solid.name || part == cloth.parts().end()) continue;
      Solid variant = solid;
      if (pair.thickness >= 0.0) variant.thickness = pair.thickness;
      if (pair.friction >= 0.0) variant.friction = pair.friction;
      const auto nodes = static_cast<std::size_t>(cloth.nodes());
      result.solids.push_back(std::move(variant));
      result.meets.emplace_back(nodes, 0);
      result.of.push_back(k);
      result.meets[general].resize(nodes, 1);
      for (Index i = part->first_node; i < part->first_node + part->node_count; ++i)
        result.meets.back()[i] = 1, result.meets[general][i] = 0;
    }
  }
  return result;
}

}  // namespace taut
