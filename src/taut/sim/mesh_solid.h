#pragma once
// A solid given by a triangle mesh, closed or open: still, moving rigidly with its pose, or
// deforming with a sequence of positions.
//
//   x_world(t) = pose(t) * shape(t)
//   shape(t)   the mesh's vertices, scaled and turned to Taut's z; or of a motion with samples s_0,
//              s_1, ... at `rate` a second: linear in between, s_0 before time 0, the last one held

#include "taut/contact/solid.h"
#include "taut/mesh/triangle_mesh.h"

namespace taut {

class MeshSolid {
 public:
  // Reads the files. Throws InputError as read_mesh and read_motion, and for a triangle that names
  // a vertex twice.
  MeshSolid(const Solid& solid, const std::filesystem::path& folder);

  const Solid& solid() const { return solid_; }
  const std::vector<Triangle>& triangles() const { return mesh_.triangles; }
  Index vertices() const { return static_cast<Index>(mesh_.positions.size()); }
  // Of what the files hold (base/checksum.h).
  std::uint64_t mesh_sum() const { return mesh_sum_; }
  std::uint64_t motion_sum() const { return motion_sum_; }
  // m, at this time (s), one a vertex.
  void positions(double time, std::span<Vec3> x) const;

 private:
  Vec3 local(std::size_t vertex, double time) const;

  Solid solid_;
  TriangleMesh mesh_;
  std::vector<std::vector<Vec3>> samples_;
  std::uint64_t mesh_sum_ = 0, motion_sum_ = 0;
};

}  // namespace taut
