#include "taut/contact/pair_laws.h"

#include <algorithm>

namespace taut {

namespace {

PairLaw general_law(const ContactOptions& options, const CollisionBody& a, const CollisionBody& b) {
  if (!a.is_solid && !b.is_solid) return {options.thickness, options.friction};
  const CollisionBody& solid = a.is_solid ? a : b;
  return {solid.thickness > 0.0 ? solid.thickness : options.thickness, solid.friction};
}

bool names(const ContactPair& pair, const CollisionBody& a, const CollisionBody& b) {
  return (pair.cloth == a.name && pair.with == b.name) ||
         (pair.cloth == b.name && pair.with == a.name);
}

}  // namespace

PairLaws::PairLaws(const ContactOptions& options, std::span<const CollisionBody> bodies)
    : bodies_(static_cast<Index>(bodies.size())) {
  for (const CollisionBody& a : bodies)
    for (const CollisionBody& b : bodies) {
      PairLaw law = general_law(options, a, b);
      for (const ContactPair& pair : options.pairs) {
        if (!names(pair, a, b)) continue;
        if (pair.thickness >= 0.0) law.thickness = pair.thickness;
        if (pair.friction >= 0.0) law.friction = pair.friction;
      }
      laws_.push_back(law);
    }
}

double PairLaws::smallest_thickness() const {
  return std::ranges::min_element(laws_, {}, &PairLaw::thickness)->thickness;
}

double PairLaws::largest_thickness() const {
  return std::ranges::max_element(laws_, {}, &PairLaw::thickness)->thickness;
}

}  // namespace taut
