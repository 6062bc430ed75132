#include "taut/sim/mesh_solid.h"

#include <algorithm>
#include <cmath>

#include "taut/base/checksum.h"
#include "taut/base/error.h"
#include "taut/io/mesh_file.h"
#include "taut/io/motion_file.h"
#include "taut/mesh/mesh_sum.h"
#include "taut/mesh/topology.h"

namespace taut {

namespace {

void turn_and_scale(std::vector<Vec3>& positions, const Solid& solid) {
  for (Vec3& x : positions) {
    if (solid.y_up) x = Vec3(x.x(), -x.z(), x.y());
    x *= solid.scale;
  }
}

std::filesystem::path found(const std::filesystem::path& path,
                            const std::filesystem::path& folder) {
  return path.is_absolute() ? path : folder / path;
}

}  // namespace

MeshSolid::MeshSolid(const Solid& solid, const std::filesystem::path& folder)
    : solid_(solid), mesh_(read_mesh(found(solid.mesh, folder), solid.prim)) {
  const MeshFaults faults = find_faults(mesh_);
  for (const Index triangle : faults.repeated_vertex)
    throw InputError(
        {found(solid.mesh, folder).string()},
        "triangle " + std::to_string(triangle + 1) + " names a vertex twice; remove it");
  mesh_sum_ = sum_of(mesh_);
  turn_and_scale(mesh_.positions, solid_);
  if (!solid_.motion.empty()) samples_ = read_motion(found(solid_.motion, folder), vertices());
  Checksum motion;
  for (auto& sample : samples_) {
    motion.add_items(std::span<const Vec3>(sample));
    turn_and_scale(sample, solid_);
  }
  motion_sum_ = motion.value();
}

Vec3 MeshSolid::local(std::size_t vertex, double time) const {
  if (samples_.empty()) return mesh_.positions[vertex];
  const double place =
      std::clamp(time * solid_.motion_rate, 0.0, static_cast<double>(samples_.size() - 1));
  const std::size_t before = std::min(static_cast<std::size_t>(place), samples_.size() - 1),
                    after = std::min(before + 1, samples_.size() - 1);
  const double share = place - static_cast<double>(before);
  return (1.0 - share) * samples_[before][vertex] + share * samples_[after][vertex];
}

void MeshSolid::positions(double time, std::span<Vec3> x) const {
  const Pose pose = solid_.pose(time);
  const Mat3 rotation = pose.rotation.toRotationMatrix();
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = rotation * local(k, time) + pose.translation;
}

}  // namespace taut
