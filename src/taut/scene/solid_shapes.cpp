#include "taut/scene/solid_shapes.h"

#include <Eigen/Geometry>
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
    case SolidShape::mesh:
      break;
  }
  return {};
}

SolidMesh mesh_of(const MeshSolid& solid, double time) {
  SolidMesh drawn;
  drawn.mesh.positions.resize(static_cast<std::size_t>(solid.vertices()));
  drawn.mesh.triangles = solid.triangles();
  solid.positions(time, drawn.mesh.positions);
  drawn.normals.assign(drawn.mesh.positions.size(), Vec3::Zero());
  for (const Triangle& t : drawn.mesh.triangles) {
    const auto& x = drawn.mesh.positions;
    const Vec3 normal = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
    for (const Index vertex : t) drawn.normals[vertex] += normal;
  }
  for (Vec3& n : drawn.normals) n = n.norm() > 0.0 ? Vec3(n.normalized()) : Vec3::UnitZ();
  return drawn;
}

SolidShapes::SolidShapes(const Scene& scene) : solids_(scene.solids) {
  for (std::size_t k = 0; k < solids_.size(); ++k)
    if (solids_[k].shape == SolidShape::mesh) meshes_.emplace(k, MeshSolid(solids_[k], scene.folder));
}

SolidMesh SolidShapes::at(std::size_t solid, double time, int segments) const {
  const auto mesh = meshes_.find(solid);
  return mesh == meshes_.end() ? mesh_of(solids_[solid], time, segments) : mesh_of(mesh->second, time);
}

bool moves(const Solid& solid) {
  if (!solid.motion.empty()) return true;
  if (solid.key_frames.empty()) return !solid.velocity.isZero(0) || !solid.angular_velocity.isZero(0);
  return std::any_of(solid.key_frames.begin(), solid.key_frames.end(),
                     [&](const KeyFrame& key) { return !(key.pose == solid.key_frames.front().pose); });
}

}  // namespace taut
