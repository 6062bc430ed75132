#pragma once
// Where two surfaces cross, and which way to go for the crossing to become shorter (Volino &
// Magnenat-Thalmann 2006, "Resolving surface collisions through intersection contour minimization",
// section 3; derivation: docs/design/untangling.md).
//
//   contour   the line in which surfaces cross, a segment for each pair of triangles. A segment
//             ends where an edge of one triangle meets the other (contact/intersection.h)
//   E, N      direction of the edge; normal of the triangle it meets
//   R_f       unit vector along the segment, from its end into face f of the edge
//   G         sum_f R_f - 2 (E·R_f)/(E·N) N: moving the edge by d against the triangle changes the
//             contour's length at this end by -G·d/2
//
// As long as a contour has an end on a border, or closes around a spot that can be drawn back,
// shrinking it to nothing separates the surfaces; it needs no history, and no notion of inside.

#include <array>

#include "taut/contact/intersection.h"

namespace taut {

// The faces of each edge: for edge e the vertices opposite to it, opposite[first[e]] ...
// opposite[first[e + 1] - 1]. Any number; one on a border.
struct EdgeFaces {
  std::vector<Index> first, opposite;
  explicit EdgeFaces(const CollisionSurface& surface);
  std::span<const Index> of(Index edge) const {
    return std::span(opposite).subspan(first[edge], first[edge + 1] - first[edge]);
  }
};

struct ContourEnd {
  std::array<Index, 5> node{};  // the edge's two, the triangle's three
  // 1 - s, s, -a, -b, -c: the edge's point minus the triangle's (collision_pair.h)
  std::array<double, 5> weight{};
  Vec3 gradient = Vec3::Zero();  // G, no unit
  Vec3 normal = Vec3::Zero();    // N, length 1; zero where the triangle has no area
  double height = 0.0;           // m: of the edge's first node over the triangle's plane, along N
};

// Finite for any shape: where E·N is lost, its size is taken as a hundredth of |E|.
ContourEnd contour_end(const CollisionSurface& surface, const EdgeFaces& faces,
                       const Intersection& at, std::span<const Vec3> x);

}  // namespace taut
