#pragma once
// What any two bodies of a collision surface keep between them: their thickness (m) and friction
// (Coulomb's mu).
//
//   two cloths, or one and itself   the scene's, ContactOptions::thickness and friction
//   a cloth and a solid             the solid's; its thickness, if 0, as cloth to cloth
//   a ContactPair                   goes before both

#include <span>
#include <string>
#include <vector>

#include "taut/base/types.h"
#include "taut/contact/contact_options.h"

namespace taut {

// A cloth or a solid's mesh, in the order of the surface's parts.
struct CollisionBody {
  std::string name;
  bool is_solid = false;
  double thickness = 0.0;  // m, of a solid: kept to cloth; 0: as cloth to cloth
  double friction = 0.0;   // of a solid with cloth
};

struct PairLaw {
  double thickness = 0.0, friction = 0.0;
};

class PairLaws {
 public:
  // At least one body. Pairs that name something else than these bodies (an
  // analytic solid) are passed over.
  PairLaws(const ContactOptions& options, std::span<const CollisionBody> bodies);
  const PairLaw& of(Index body, Index other) const {
    return laws_[static_cast<std::size_t>(body * bodies_ + other)];
  }
  double smallest_thickness() const;
  double largest_thickness() const;

 private:
  Index bodies_;
  std::vector<PairLaw> laws_;
};

}  // namespace taut
