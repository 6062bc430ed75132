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

std::string SolidShapes::name(std::size_t k) const { return solid(k).name.empty() ? "solid_" + std::to_string(k) : solid(k).name; }

bool SolidShapes::moves(std::size_t k) const {
  const Solid& s = solid(k);
  if (s.key_frames.empty()) return !s.velocity.isZero(0) || !s.angular_velocity.isZero(0);
  return std::any_of(s.key_frames.begin(), s.key_frames.end(),
                     [&](const KeyFrame& key) { return !(key.pose == s.key_frames.front().pose); });
}

SolidMesh SolidShapes::at(std::size_t k, double time) const {
  constexpr double plane_radius = 3.0;
  const Solid& s = solid(k);
  const Isometry pose = isometry(s.pose(time));
  switch (s.shape) {
    case SolidShape::sphere:
      return make_sphere_mesh(s.radius, pose, segments_);
    case SolidShape::plane:
      return make_disc_mesh(plane_radius, pose, segments_);
    case SolidShape::cylinder:
      return make_cylinder_mesh(s.radius, s.height, pose, segments_);
    case SolidShape::box:
      return make_box_mesh(s.size, pose);
  }
  return {};
}

}  // namespace taut
