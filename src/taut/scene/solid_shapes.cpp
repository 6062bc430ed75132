#include "taut/scene/solid_shapes.h"

#include <algorithm>

namespace taut {

namespace {

Isometry isometry(const Pose& pose) {
  Isometry result = Isometry::Identity();
  result.translate(pose.translation);
  result.rotate(pose.rotation);
  return result;
}

}  // namespace

SolidMesh mesh_of(const Solid& solid, double time, int segments) {
  constexpr double plane_radius = 3.0;
  const Isometry pose = isometry(solid.pose(time));
  switch (solid.shape) {
    case SolidShape::sphere:
      return make_sphere_mesh(solid.radius, pose, segments);
    case SolidShape::plane:
      return make_disc_mesh(plane_radius, pose, segments);
    case SolidShape::cylinder:
      return make_cylinder_mesh(solid.radius, solid.height, pose, segments);
    case SolidShape::box:
      return make_box_mesh(solid.size, pose);
  }
  return {};
}

bool moves(const Solid& solid) {
  if (solid.key_frames.empty()) return !solid.velocity.isZero(0) || !solid.angular_velocity.isZero(0);
  return std::any_of(solid.key_frames.begin(), solid.key_frames.end(),
                     [&](const KeyFrame& key) { return !(key.pose == solid.key_frames.front().pose); });
}

}  // namespace taut
