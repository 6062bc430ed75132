#pragma once
// The first half of untangle.h: passes that draw surfaces through one another
// until nothing intersects.

#include "taut/contact/contour_gradient.h"
#include "taut/contact/edge_lengths.h"
#include "taut/contact/untangle.h"

namespace taut {

// One way of stepping.
struct SeparationWay {
  double step;  // m: how far nodes at a contour move in a pass
  bool spots;   // whether spots move as a whole, too
};

struct SeparationResult {
  int passes = 0;
  std::vector<Intersection> left;  // at the pass with the fewest
};

// Nodes deeper than `tolerance` (m) inside a solid; moved to the nearest place outside
// if `x` is to be changed.
Index push_out_of_solids(const UntangleInput& input, std::span<Vec3> x, double tolerance);
Index count_inside_solids(const UntangleInput& input, std::span<const Vec3> x, double tolerance);

SeparationResult separate(const UntangleInput& input, const EdgeFaces& faces,
                          std::span<const LengthRange> ranges, BroadPhase& broad_phase,
                          const SeparationWay& way, const UntangleOptions& options,
                          std::span<Vec3> x);

}  // namespace taut
