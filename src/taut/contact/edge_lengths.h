#pragma once
// Keeps a surface's shape: the lengths of its edges within ranges, by moving nodes
// as little as that takes.
//
//   least, most   m, one range an edge of the surface, in its order
//   method        position-based projection (Müller, Heidelberger, Hennix & Ratcliff 2007): an edge
//                 outside its range is brought back to the nearer end by moving its free nodes
//                 equally, one edge after the other in fixed order

#include <cstdint>

#include "taut/contact/collision_surface.h"

namespace taut {

struct LengthRange {
  double least = 0.0, most = 0.0;
};

// From each edge's length at x to its length at rest, whichever is greater, and
// `slack` (a share) beyond both.
std::vector<LengthRange> length_ranges(const CollisionSurface& surface, std::span<const Vec3> x,
                                       std::span<const double> rest, double slack);

// held: not 0 for nodes that stay. Edges of solids are passed over.
void project_lengths(const CollisionSurface& surface, std::span<const LengthRange> ranges,
                     std::span<const std::uint8_t> held, std::span<Vec3> x, int iterations);

// Over all edges of cloth: the largest |L / rest - 1|; and by how much, as a share, edges are
// outside their ranges at most.
double worst_stretch(const CollisionSurface& surface, std::span<const double> rest,
                     std::span<const Vec3> x);
double worst_excess(const CollisionSurface& surface, std::span<const LengthRange> ranges,
                    std::span<const Vec3> x);

}  // namespace taut
