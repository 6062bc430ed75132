#include "taut/results/solid_shapes.h"

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

// Normals at the vertices are means over their triangles.
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
  for (Vec3& n : drawn.normals) n = n.norm() > 0.0 ? Vec3(n.normalized()) : Vec3(Vec3::UnitZ());
  return drawn;
}

}  // namespace

SolidShapes::SolidShapes(const Scene& scene, int segments) : scene_(scene), segments_(segments) {
  for (std::size_t k = 0; k < scene.solids.size(); ++k)
    if (scene.solids[k].shape == SolidShape::mesh)
      meshes_.emplace(k, MeshSolid(scene.solids[k], read_surface(scene.solids[k], scene.folder)));
}

std::string SolidShapes::name(std::size_t k) const {
  return solid(k).name.empty() ? "solid_" + std::to_string(k) : solid(k).name;
}

bool SolidShapes::moves(std::size_t k) const {
  const SolidEntry& s = solid(k);
  if (!s.motion.empty()) return true;
  if (s.key_frames.empty()) return !s.velocity.isZero(0) || !s.angular_velocity.isZero(0);
  return std::any_of(s.key_frames.begin(), s.key_frames.end(),
                     [&](const KeyFrame& key) { return !(key.pose == s.key_frames.front().pose); });
}

SolidMesh SolidShapes::at(std::size_t k, double time) const {
  constexpr double plane_radius = 3.0;
  const SolidEntry& s = solid(k);
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
    case SolidShape::mesh:
      return mesh_of(meshes_.at(k), time);
  }
  return {};
}

}  // namespace taut
