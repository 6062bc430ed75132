#include "taut/sim/solid_variants.h"

#include <algorithm>

namespace taut {

SolidVariants solid_variants(const Scene& scene, const ClothModel& cloth) {
  SolidVariants result;
  for (const Solid& solid : scene.solids) {
    const std::size_t general = result.solids.size();
    result.solids.push_back(solid);
    result.meets.emplace_back();
    // Meshes are part of the collision surface, which has its own table (contact/pair_laws.h).
    if (solid.shape == SolidShape::mesh) continue;
    for (const ContactPair& pair : scene.contact.pairs) {
      const auto part = std::ranges::find(cloth.parts(), pair.cloth, &ClothPart::name);
      if (pair.with != solid.name || part == cloth.parts().end()) continue;
      Solid variant = solid;
      if (pair.thickness >= 0.0) variant.thickness = pair.thickness;
      if (pair.friction >= 0.0) variant.friction = pair.friction;
      const auto nodes = static_cast<std::size_t>(cloth.nodes());
      result.solids.push_back(std::move(variant));
      result.meets.emplace_back(nodes, 0);
      result.meets[general].resize(nodes, 1);
      for (Index i = part->first_node; i < part->first_node + part->node_count; ++i)
        result.meets.back()[i] = 1, result.meets[general][i] = 0;
    }
  }
  return result;
}

}  // namespace taut
