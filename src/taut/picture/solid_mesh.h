#pragma once
// Meshes of simple solids for drawing, with exact normals at the vertices (edges stay sharp:
// vertices there are doubled).
//
//   pose       x_world = pose * x_local (rotation and translation)
//   sphere     centre 0, `radius`; u around z, v from the south pole to the north pole
//   disc       in the plane z = 0, front +z, `radius`: a finite piece of a plane
//   quad       in the plane z = 0, front +z, sides `size_x`, `size_y`
//   cylinder   axis z, |z| <= height/2, `radius`, flat caps
//   box        |x| <= size.x/2, |y| <= size.y/2, |z| <= size.z/2
//
// Lengths in m; all triangles counter-clockwise seen from outside. `segments` is the number of
// corners around a circle: 96 keep the outline within 0.06 % of the radius. Throws InputError when
// a length is negative or not finite, or segments < 3; a length 0 is allowed (flat solid).

#include <Eigen/Geometry>

#include "taut/picture/surface.h"

namespace taut {

using Isometry = Eigen::Isometry3d;

struct SolidMesh {
  TriangleMesh mesh;
  std::vector<Vec3> normals;
};

SolidMesh make_sphere_mesh(double radius, const Isometry& pose = Isometry::Identity(),
                           int segments = 96);
SolidMesh make_disc_mesh(double radius, const Isometry& pose = Isometry::Identity(),
                         int segments = 96);
SolidMesh make_quad_mesh(double size_x, double size_y, const Isometry& pose = Isometry::Identity());
SolidMesh make_cylinder_mesh(double radius, double height,
                             const Isometry& pose = Isometry::Identity(), int segments = 96);
SolidMesh make_box_mesh(const Vec3& size, const Isometry& pose = Isometry::Identity());

// How a solid is drawn: one colour on both sides, opaque, a soft highlight.
Surface solid_surface(const SolidMesh& solid, const Colour& colour = Colour(0.78, 0.77, 0.75));

}  // namespace taut
