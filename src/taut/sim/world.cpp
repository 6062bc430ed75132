#include "taut/sim/world.h"

#include <fmt/format.h>

namespace taut {

ClothHandle World::add_cloth(ClothOptions cloth) {
  const int index = static_cast<int>(cloths_.size());
  if (cloth.name.empty()) cloth.name = fmt::format("cloth_{}", index);
  cloths_.push_back(std::move(cloth));
  return {index};
}

PinHandle World::pin(ClothHandle cloth, std::vector<Index> nodes, PinPath path) {
  pins_.push_back({cloth, std::move(nodes), std::move(path)});
  return {static_cast<int>(pins_.size()) - 1};
}

SolidHandle World::add_solid(Solid solid) {
  const int index = static_cast<int>(solids_.size());
  if (solid.name.empty()) solid.name = fmt::format("solid_{}", index);
  solids_.push_back(std::move(solid));
  surfaces_.emplace_back();
  return {index};
}

SolidHandle World::add_solid(Solid solid, SolidSurface surface) {
  solid.shape = SolidShape::mesh;
  const SolidHandle handle = add_solid(std::move(solid));
  surfaces_.back() = std::move(surface);
  return handle;
}

void World::set_material(ClothHandle cloth, const SpringMaterial& material) {
  cloths_.at(static_cast<std::size_t>(cloth.index)).material = material;
}

void World::set_motion(SolidHandle solid, const Solid& motion) {
  Solid& s = solids_.at(static_cast<std::size_t>(solid.index));
  s.key_frames = motion.key_frames;
  s.initial = motion.initial;
  s.velocity = motion.velocity;
  s.angular_velocity = motion.angular_velocity;
}

}  // namespace taut
