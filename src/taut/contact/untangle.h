#pragma once
// Draws cloth that intersects itself, other cloth or solids apart, from positions only: no history,
// no velocities. How: docs/design/untangling.md; docs/mathematics.md, 7.9.
//
//   separate   passes that shrink contours until the exact check (contact/intersection.h) finds
//              nothing
//   settle     rounds of ClothContact::resolve without friction, which push layers apart and
//              restore the edges' lengths, on ways that are proved free
//
// Separation may end in a minimum that is not zero: a ring that another cloth passes through, two
// sheets crossed from border to border, cloth inside a closed mesh. What cannot be repaired with
// edges at most `most_excess` outside the range between what they are and their rest length is
// given back as it was. Deterministic: the same bits for any number of threads. A pass costs one
// exact check and a few loops over edges.

#include "taut/base/status.h"
#include "taut/contact/cloth_contact.h"
#include "taut/contact/intersection.h"

namespace taut {

struct UntangleOptions {
  int most_passes = 400;  // of each way of stepping
  // passes without fewer intersections than ever before, after which it is given up
  int patience = 100;
  int most_rounds = 80;       // of settling
  double most_excess = 0.05;  // share of an edge's length
};

struct UntangleInput {
  const CollisionSurface& surface;
  std::span<const CollisionBody> bodies;
  std::span<const double> mass;        // kg, one a vertex
  std::span<const std::uint8_t> held;  // one a vertex, not 0: stays (pins, solids)
  std::span<const double> rest;        // m, rest length of each edge
  // as they stand at time 0; meshes among them are part of the surface
  std::span<const Solid> solids;
  ContactOptions contact;  // thickness > 0
};

struct UntangleReport {
  // not ok: nothing was moved, and the message says why
  Status status;
  Index intersections_before = 0;  // pairs of an edge and a triangle
  // nodes inside analytic solids, beyond their thickness or contact.touch_tolerance
  Index inside_solids_before = 0;
  // the same, and deeper than a twentieth of contact.thickness
  Index inside_solids_after = 0;
  int attempts = 0, passes = 0, rounds = 0;          // of all attempts; of settling
  Index moved = 0;                                   // nodes
  double largest = 0.0, mean = 0.0;                  // m: displacements; mean of the moved nodes
  double stretch_before = 0.0, stretch_after = 0.0;  // the largest |L / rest - 1| of all edges
  // m: least distance of two features within the thickness afterwards, at most the thickness
  double gap = 0.0;
  std::vector<Intersection> left;  // not ok: those of the best attempt
};

// x: m, one a vertex. Changed only if there was something to repair and the status is ok.
UntangleReport untangle(const UntangleInput& input, std::span<Vec3> x,
                        const UntangleOptions& options = {});

}  // namespace taut
