#include "taut/contact/solid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {
namespace {

Pose between(const KeyFrame& a, const KeyFrame& b, double time) {
  const double share = (time - a.time) / (b.time - a.time);
  Pose pose;
  pose.translation = (1.0 - share) * a.pose.translation + share * b.pose.translation;
  pose.rotation = a.pose.rotation.slerp(share, b.pose.rotation).normalized();
  return pose;
}

Pose keyed_pose(const std::vector<KeyFrame>& frames, double time) {
  const auto after = std::upper_bound(frames.begin(), frames.end(), time,
                                      [](double t, const KeyFrame& f) { return t < f.time; });
  if (after == frames.begin()) return frames.front().pose;
  if (after == frames.end()) return frames.back().pose;
  return between(*(after - 1), *after, time);
}

SurfacePoint sphere_surface(double radius, const Vec3& p) {
  const double r = p.norm();
  return {r - radius, r > 0.0 ? Vec3(p / r) : Vec3::UnitZ()};
}

SurfacePoint box_surface(const Vec3& size, const Vec3& p) {
  // positive where p lies outside the slab of that axis
  const Vec3 beyond = p.cwiseAbs() - 0.5 * size;
  const Vec3 outside = beyond.cwiseMax(0.0);
  const double distance = outside.norm();
  if (distance > 0.0) {
    Vec3 normal = outside / distance;
    for (int k = 0; k < 3; ++k) normal[k] = std::copysign(normal[k], p[k]);
    return {distance, normal};
  }
  Eigen::Index axis = 0;
  const double depth = beyond.maxCoeff(&axis);
  Vec3 normal = Vec3::Zero();
  normal[axis] = std::copysign(1.0, p[axis]);
  return {depth, normal};
}

SurfacePoint cylinder_surface(double radius, double height, const Vec3& p) {
  const double r = std::hypot(p.x(), p.y());
  const Vec3 radial = r > 0.0 ? Vec3(p.x() / r, p.y() / r, 0.0) : Vec3::UnitX();
  const Vec3 axial = std::copysign(1.0, p.z()) * Vec3::UnitZ();
  const double beyond_side = r - radius, beyond_cap = std::abs(p.z()) - 0.5 * height;
  if (beyond_side > 0.0 && beyond_cap > 0.0) {
    const double distance = std::hypot(beyond_side, beyond_cap);
    return {distance, (beyond_side * radial + beyond_cap * axial) / distance};
  }
  return beyond_side > beyond_cap ? SurfacePoint{beyond_side, radial}
                                  : SurfacePoint{beyond_cap, axial};
}

}  // namespace

Pose Solid::pose(double time) const {
  if (!key_frames.empty()) return keyed_pose(key_frames, time);
  Pose moved = initial;
  moved.translation += time * velocity;
  const double speed = angular_velocity.norm();
  if (speed > 0.0)
    moved.rotation = Eigen::AngleAxisd(speed * time, angular_velocity / speed) * initial.rotation;
  return moved;
}

SurfacePoint closest_surface(const Solid& solid, const Vec3& local) {
  switch (solid.shape) {
    case SolidShape::sphere:
      return sphere_surface(solid.radius, local);
    case SolidShape::plane:
      return {local.z(), Vec3::UnitZ()};
    case SolidShape::cylinder:
      return cylinder_surface(solid.radius, solid.height, local);
    case SolidShape::box:
      return box_surface(solid.size, local);
    case SolidShape::mesh:
      return {std::numeric_limits<double>::infinity(), Vec3::UnitZ()};
  }
  return {};
}

double surface_distance(const Solid& solid, const Vec3& local) {
  if (solid.shape == SolidShape::plane) return local.z();
  if (solid.shape == SolidShape::sphere) return local.norm() - solid.radius;
  if (solid.shape != SolidShape::box) return closest_surface(solid, local).distance;
  const Vec3 beyond = local.cwiseAbs() - 0.5 * solid.size;
  const double outside = beyond.cwiseMax(0.0).norm();
  return outside > 0.0 ? outside : beyond.maxCoeff();
}

double depth_inside(const Solid& solid, const Vec3& x, double time) {
  if (solid.shape == SolidShape::mesh) return 0.0;
  return solid.thickness - closest_surface(solid, solid.pose(time).to_local(x)).distance;
}

}  // namespace taut
