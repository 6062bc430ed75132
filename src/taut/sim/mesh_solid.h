#pragma once
// A solid given by a triangle mesh, closed or open: still, moving rigidly with its pose, or
// deforming with a sequence of positions.
//
//   x_world(t) = pose(t) * shape(t)
//   shape(t)   the mesh's vertices; or of samples s_0, s_1, ... at `rate` a second: linear in
//              between, s_0 before time 0, the last one held; or where the program puts them

#include "taut/contact/solid.h"
#include "taut/sim/world.h"

namespace taut {

class MeshSolid {
 public:
  MeshSolid(const Solid& solid, SolidSurface surface);

  const Solid& solid() const { return solid_; }
  const std::vector<Triangle>& triangles() const { return surface_.mesh.triangles; }
  Index vertices() const { return static_cast<Index>(surface_.mesh.positions.size()); }
  // m, at this time (s), one a vertex.
  void positions(double time, std::span<Vec3> x) const;

  // Another motion of the same solid: key frames, pose and velocities of `solid`.
  void set_motion(const Solid& solid) { solid_ = solid; }
  // Its shape, in its own coordinates, goes from what it is at t0 to this at t1 (s), then stays.
  void deform(std::vector<Vec3> shape, double t0, double t1);
  // What deform has said, of the shape at t0 and at t1; empty: nothing.
  struct Deformation {
    std::vector<Vec3> from, to;
    double t0 = 0.0, t1 = 0.0;
  };
  const Deformation& deformation() const { return deformation_; }
  void set_deformation(Deformation deformation) { deformation_ = std::move(deformation); }

 private:
  Vec3 local(std::size_t vertex, double time) const;

  Solid solid_;
  SolidSurface surface_;
  Deformation deformation_;
};

}  // namespace taut
