#pragma once
// Taut's own intersection check: all pairs of an edge and a triangle without a common vertex that
// meet, decided exactly.
//
//   meet      the closed edge and the closed triangle have a point in common: crossing, touching,
//             overlapping in one plane all count
//   touching  they meet, but some corner lies exactly in the other's plane or line: moved by
//             however little they may come apart
//
// Two triangles that share no vertex intersect exactly if an edge of one meets the other. Decisions
// are signs of determinants of the given doubles: a floating-point value where its error bound
// leaves no doubt, else exact expansion arithmetic (J. R. Shewchuk, "Adaptive Precision
// Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997). Exact as long as
// coordinates that are not 0 lie between 1e-70 and 1e70 in magnitude. Triangles without area and
// edges without length are decided too, as the segment or the point that they are.

#include <span>
#include <vector>

#include "taut/contact/broad_phase.h"

namespace taut {

struct Intersection {
  Index edge = 0, triangle = 0;
  bool touching = false;
  auto operator<=>(const Intersection&) const = default;
};

// Does the segment a b meet the triangle c d e?
struct Meeting {
  bool meets = false;
  bool touching = false;
};
Meeting segment_meets_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                               const Vec3& e);

// All intersections at positions x (m, one a vertex), sorted by edge, then triangle; solid-solid
// pairs are left out. Refits `broad_phase` to x. surface.body tells the bodies:
// surface.body[surface.edges[edge][0]] and surface.body[surface.triangles[triangle][0]].
std::vector<Intersection> find_intersections(BroadPhase& broad_phase, std::span<const Vec3> x);

}  // namespace taut
