#pragma once
// A checksum of a mesh's vertices (m) and triangles, what a simulation takes from a mesh file:
// tells whether the file has changed.

#include "taut/base/checksum.h"
#include "taut/mesh/triangle_mesh.h"

namespace taut {

inline std::uint64_t sum_of(const TriangleMesh& mesh) {
  Checksum sum;
  sum.add_items(std::span<const Vec3>(mesh.positions));
  sum.add_items(std::span<const Triangle>(mesh.triangles));
  return sum.value();
}

}  // namespace taut
