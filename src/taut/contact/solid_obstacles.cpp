// What SolidContact tells the response of cloth to cloth: the planes that nodes must stay outside
// of.

#include "taut/contact/solid_contact.h"

namespace taut {

Obstacle SolidContact::obstacle(const SolidStep& step, Index node, const Vec3& x_end) const {
  const Vec3& x0 = start_[node];
  const LandingPlane plane = step.landing(x_end, step.anchor(x0, x_end, options_.touch_tolerance));
  return {static_cast<Index>(&step - steps_.data()), plane.normal,
          plane.normal.dot(x_end) - plane.gap, step.carried_from(x0), step.friction()};
}

std::optional<Obstacle> SolidContact::obstacle(Index node, const Vec3& x_end) const {
  for (std::size_t s = 0; s < steps_.size(); ++s)
    if (may_meet(s, node) && steps_[s].meets(start_[node], x_end, -depth_tolerance(steps_[s])))
      return obstacle(steps_[s], node, x_end);
  return {};
}

std::vector<std::pair<Index, Obstacle>> SolidContact::touched(std::span<const Vec3> x_end) const {
  std::vector<std::pair<Index, Obstacle>> touched;
  for (const Contact& contact : contacts_)
    touched.emplace_back(contact.node,
                         obstacle(step_of(contact), contact.node, x_end[contact.node]));
  return touched;
}

}  // namespace taut
