#pragma once
// Joins contact/cloth_contact.h to the loop: builds the surface of all cloths and mesh solids, says what each node may do in a step, and
// keeps zones from one step to the next.
//
//   before the solve   hold_zones: nodes that were in a rigid zone go on with their rigid velocity as ndof 0 and are eliminated, for one step;
//                      then they are free again, unless they collide again later
//   after it           correct: the end positions without a collision, or why not
//
// Nodes are the surface's first vertices, in their order; solids' vertices follow.

#include <memory>

#include "taut/contact/cloth_contact.h"
#include "taut/contact/intersection.h"
#include "taut/scene/cloth_model.h"

namespace taut {

class SurfaceContact {
 public:
  SurfaceContact(const Scene& scene, const ClothModel& cloth);

  void hold_zones(const State& state, double h, ConstraintSet& constraints) const;

  // The step [t, t + h] from x0. pins: what holds nodes whatever happens. x_end is changed; true in `changed` if any node was moved.
  Status correct(double h, std::span<const Vec3> x0, const ConstraintSet& pins, const SolidContact& solids, std::span<Vec3> x_end, bool& changed);
  // The corrected step counts: its zones are held in the next.
  void keep();

  std::vector<Intersection> intersections(std::span<const Vec3> x);
  // "cloth 'a', triangle 12, and cloth 'b', triangle 40": where the first of them is.
  std::string describe(const Intersection& intersection) const;

  const ClothContactCounts& counts() const { return contact_->counts(); }
  const ClothContact& contact() const { return *contact_; }
  const ZoneState& state() const { return kept_; }
  // Throws InputError on a state that does not fit.
  void restore(ZoneState state);

 private:
  void weigh_nodes(const ConstraintSet& pins);

  Vec3 gravity_;
  Index nodes_;
  std::vector<double> mass_;
  std::unique_ptr<ClothContact> contact_;
  ZoneState kept_;
  std::vector<Vec3> x0_, x1_;
  std::vector<double> inverse_mass_;
  std::vector<std::uint8_t> held_;
};

}  // namespace taut
