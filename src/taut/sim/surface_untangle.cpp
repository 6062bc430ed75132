// The start of a scene, drawn apart (contact/untangle.h).

#include <fmt/format.h>

#include <map>

#include "taut/base/error.h"
#include "taut/sim/surface_contact.h"

namespace taut {

namespace {

// Of each edge of the surface: that of the spring along it, where there is one, else what it is at
// x. m.
std::vector<double> rest_lengths(const CollisionSurface& surface, const ClothModel& cloth,
                                 std::span<const Vec3> x) {
  std::map<EdgeVertices, double> of_springs;
  for (const auto& model : cloth.springs()) {
    if (model->force_class() == ForceClass::bend) continue;
    for (const Spring& spring : model->springs())
      of_springs.emplace(EdgeVertices{std::min(spring.i, spring.j), std::max(spring.i, spring.j)},
                         spring.parameters.rest_length);
  }
  std::vector<double> lengths;
  for (const EdgeVertices& edge : surface.edges) {
    const auto found = of_springs.find(edge);
    lengths.push_back(found == of_springs.end() ? (x[edge[1]] - x[edge[0]]).norm() : found->second);
  }
  return lengths;
}

// The pinned nodes that no untangling takes out of solids; "" when there are none.
std::string pins_inside(const World& world, const ClothModel& cloth, std::span<const Vec3> x,
                        std::span<const std::uint8_t> held) {
  std::string text;
  for (const ClothPart& part : cloth.parts())
    for (const Solid& solid : world.solids())
      for (Index i = 0; i < part.node_count; ++i) {
        const auto node = static_cast<std::size_t>(part.first_node + i);
        const double depth = held[node] ? depth_inside(solid, x[node], 0.0) : 0.0;
        if (depth <= world.contact.touch_tolerance) continue;
        text +=
            fmt::format("\n  a pin holds node {} of cloth '{}' inside solid '{}', {:.3g} m deep", i,
                        part.name, solid.name, depth);
        break;  // one a cloth and solid is enough to find the pin
      }
  return text;
}

}  // namespace

void SurfaceContact::untangle_start(const World& world, ClothModel& cloth) {
  std::vector<Vec3> x = positions(0.0, cloth.start().x);
  ConstraintSet pins(nodes_);
  cloth.constrain_pins(0.0, 0.0, cloth.start().x, pins);
  std::vector<std::uint8_t> held(x.size(), 1);
  for (Index i = 0; i < nodes_; ++i) held[i] = pins.ndof(i) == 0;
  const CollisionSurface& surface = contact_->surface();
  const std::vector<double> rest = rest_lengths(surface, cloth, x);
  untangled_ = untangle(
      {surface, contact_->bodies(), mass_, held, rest, world.solids(), contact_->options()}, x);
  if (const std::string inside = untangled_->status.ok() ? "" : pins_inside(world, cloth, x, held);
      !inside.empty())
    throw InputError(
        fmt::format("the start cannot be untangled, since pins are not moved:{}\nNothing was "
                    "changed. Move the pin or the solid",
                    inside));
  if (!untangled_->status.ok())
    throw InputError(
        fmt::format("cloth that intersects at the start cannot be drawn apart: {}{}\nNothing was "
                    "changed. Move the cloths apart where "
                    "they start, or start as it is with contact.allow_intersections = true and "
                    "without --untangle",
                    untangled_->status.message, places(untangled_->left)));
  if (untangled_->moved > 0)
    cloth.place_start(std::span<const Vec3>(x).first(static_cast<std::size_t>(nodes_)));
}

std::string describe(const UntangleReport& report) {
  if (report.moved == 0)
    return "nothing to untangle at the start: no intersections, no node inside a solid";
  return fmt::format(
      "untangled: {} intersections at the start, none now; {} nodes inside solids, {} now; moved "
      "{} nodes, by up to {:.3g} mm, {:.3g} mm on "
      "average; worst stretch {:.2g} % before, {:.2g} % now; layers at least {:.2g} mm apart ({} "
      "passes)",
      report.intersections_before, report.inside_solids_before, report.inside_solids_after,
      report.moved, 1e3 * report.largest, 1e3 * report.mean, 100 * report.stretch_before,
      100 * report.stretch_after, 1e3 * report.gap, report.passes);
}

}  // namespace taut
