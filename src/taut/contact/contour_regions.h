#pragma once
// Spots that a contour (contact/contour_gradient.h) cuts off from the rest of their cloth: what has
// gone through and should come back.
//
//   cut       an edge that meets an odd number of triangles: its ends lie on different sides of the
//             contour
//   region    nodes of one cloth or solid joined by edges that are not cut. The largest of each is
//             its main part, the others are spots
//   way       back, of a spot, a unit vector: the mean over its cut edges of the pierced triangle's
//             normal, from the edge's end in the spot to the other; and against that for spots that
//             the triangle itself belongs to
//
// A simple form of global intersection analysis (Baraff, Witkin & Kass 2003, "Untangling cloth"),
// which pairs the two spots of a contour and lets them attract each other. A whole spot drawn back
// along its way keeps its shape, where the contour's gradient acts on its rim only.

#include "taut/contact/contour_gradient.h"

namespace taut {

struct ContourRegions {
  std::vector<Index> region;  // one a vertex: which region, counted from 0
  std::vector<Vec3> way;      // one a region; zero for main parts and spots without a clear way
};

// ends: one for each of `found`, which is sorted as find_intersections does.
ContourRegions contour_regions(const CollisionSurface& surface, std::span<const Intersection> found,
                               std::span<const ContourEnd> ends);

}  // namespace taut
