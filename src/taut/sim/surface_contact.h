#pragma once
// Joins contact/cloth_contact.h to the loop: builds the surface of all cloths and mesh solids, says
// what each node may do in a step, and keeps zones from one step to the next.
//
//   before the solve   hold_zones: nodes that were in a rigid zone go on with their rigid velocity
//                      as ndof 0 and are eliminated, for one
//   step;
//                      then they are free again, unless they collide again later
//   after it           correct: the end positions without a collision, or why not
//
// Nodes are the surface's first vertices, in their order; solids' vertices follow.

#include <memory>
#include <optional>

#include "taut/contact/cloth_contact.h"
#include "taut/contact/intersection.h"
#include "taut/contact/untangle.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/mesh_solid.h"

namespace taut {

class SurfaceContact {
 public:
  // Throws InputError when cloth intersects itself or a
  // solid at the start and the world does not allow it. With contact.untangle it is drawn apart,
  // and gets other start positions; throws when that cannot be done.
  SurfaceContact(const World& world, ClothModel& cloth);
  // Whether the world needs it: contact.self, or a solid that is a mesh.
  static bool wanted(const World& world);

  void hold_zones(const State& state, double h, ConstraintSet& constraints) const;

  // The step [t, t + h] from x0 to x_end with v_end. pins: what holds nodes whatever happens. x_end
  // is changed; true in `changed` if any node was moved, for which v_end must then change by as
  // much over h.
  Status correct(double t, double h, std::span<const Vec3> x0, std::span<const Vec3> v_end,
                 const ConstraintSet& pins, const SolidContact& solids, std::span<Vec3> x_end,
                 bool& changed);
  // The corrected step counts: its zones are held in the next, whose pairs begin with its forces.
  void keep();

  // All vertices of the surface at this time: the cloths' at x, then the solids'.
  std::vector<Vec3> positions(double time, std::span<const Vec3> x) const;
  // At this time, of the cloths at x.
  std::vector<Intersection> intersections(double time, std::span<const Vec3> x);
  // "cloth 'a', triangle 12, and cloth 'b', triangle 40": where the first of them is.
  std::string describe(const Intersection& intersection) const;

  // The solids that are meshes, in the world's order.
  std::span<const MeshSolid> solids() const { return solids_; }
  std::span<MeshSolid> solids() { return solids_; }
  void set_gravity(const Vec3& gravity) { gravity_ = gravity; }
  const ClothContactCounts& counts() const { return contact_->counts(); }
  const ClothContact& contact() const { return *contact_; }
  const ClothContactState& state() const { return kept_; }
  // What was done to the start; null without contact.untangle.
  const UntangleReport* untangled() const { return untangled_ ? &*untangled_ : nullptr; }
  // Throws InputError on a state that does not fit.
  void restore(ClothContactState state);

 private:
  void weigh_nodes(const ConstraintSet& pins);
  void place_solids(double time, std::vector<Vec3>& x) const;
  void refuse_intersections(std::span<const Vec3> start);
  void untangle_start(const World& world, ClothModel& cloth);
  std::string places(std::span<const Intersection> found) const;

  Vec3 gravity_;
  Index nodes_;
  std::vector<MeshSolid> solids_;
  std::vector<double> mass_;
  std::unique_ptr<ClothContact> contact_;
  ClothContactState kept_;
  std::optional<UntangleReport> untangled_;
  std::vector<Vec3> x0_, x1_, lever_;
  std::vector<double> inverse_mass_;
  std::vector<std::uint8_t> held_;
};

// "untangled: 12 intersections at the start, none now; ..." in one line.
std::string describe(const UntangleReport& report);

}  // namespace taut
