#pragma once
// Solids that cloth collides with, and their rigid motion.
//
//   pose(t)        x_world = rotation(t) * x_local + translation(t)
//   local shapes   sphere    centre 0, `radius`
//                  plane     the half space z <= 0: normal +z
//                  cylinder  axis z, |z| <= height/2, `radius`, flat caps
//                  box       |x| <= size.x/2, |y| <= size.y/2, |z| <= size.z/2
// Units: m, s, rad. `thickness` (m) is added outside the surface; `friction` is Coulomb's μ (static
// and kinetic alike), no unit.

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "taut/base/types.h"

namespace taut {

struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 translation = Vec3::Zero();
  Vec3 to_world(const Vec3& local) const { return rotation * local + translation; }
  Vec3 to_local(const Vec3& world) const { return rotation.conjugate() * (world - translation); }
  bool operator==(const Pose&) const = default;
};

struct KeyFrame {
  double time = 0.0;
  Pose pose;
  bool operator==(const KeyFrame&) const = default;
};

// mesh: a triangle mesh, of which closest_surface knows nothing; contact with it is that of
// surfaces (contact/cloth_contact.h).
enum class SolidShape { sphere, plane, cylinder, box, mesh };

struct Solid {
  std::string name;
  SolidShape shape = SolidShape::sphere;
  double radius = 0.1;
  double height = 1.0;
  Vec3 size = Vec3::Ones();
  double friction = 0.0;
  double thickness = 0.0;
  // Motion: between key frames positions are linear and rotations spherically linear in time;
  // before the first and after the last the pose is held. With no key frame the pose is `initial`
  // moved by the constant `velocity` (m/s) and turned by `angular_velocity` (rad/s, world axes,
  // about the solid's own origin).
  std::vector<KeyFrame> key_frames;
  Pose initial;
  Vec3 velocity = Vec3::Zero();
  Vec3 angular_velocity = Vec3::Zero();

  Pose pose(double time) const;
  bool operator==(const Solid&) const = default;
};

// Signed distance (m, negative inside, thickness not counted) from a point in local coordinates,
// and the outward unit normal there. At points with no unique normal (a sphere's centre, a box's
// edges from inside) one of the nearest is returned, always finite and of length 1.
struct SurfacePoint {
  double distance = 0.0;
  Vec3 normal = Vec3::UnitZ();
};
SurfacePoint closest_surface(const Solid& solid, const Vec3& local);
// Its distance alone, to the same bits.
double surface_distance(const Solid& solid, const Vec3& local);
// How deep a world point is inside the thickened solid at this time (s), m; not positive outside. 0
// for meshes.
double depth_inside(const Solid& solid, const Vec3& x, double time);

}  // namespace taut
