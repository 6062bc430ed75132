#include "taut/sim/mesh_solid.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace taut {

MeshSolid::MeshSolid(const Solid& solid, SolidSurface surface)
    : solid_(solid), surface_(std::move(surface)) {}

void MeshSolid::deform(std::vector<Vec3> shape, double t0, double t1) {
  assert(static_cast<Index>(shape.size()) == vertices());
  std::vector<Vec3> now(shape.size());
  for (std::size_t k = 0; k < now.size(); ++k) now[k] = local(k, t0);
  deformation_ = {std::move(now), std::move(shape), t0, t1};
}

Vec3 MeshSolid::local(std::size_t vertex, double time) const {
  if (!deformation_.to.empty()) {
    const Deformation& d = deformation_;
    if (time >= d.t1) return d.to[vertex];
    if (time <= d.t0) return d.from[vertex];
    const double share = (time - d.t0) / (d.t1 - d.t0);
    return (1.0 - share) * d.from[vertex] + share * d.to[vertex];
  }
  const auto& samples = surface_.samples;
  if (samples.empty()) return surface_.mesh.positions[vertex];
  const double place =
      std::clamp(time * surface_.rate, 0.0, static_cast<double>(samples.size() - 1));
  const std::size_t before = std::min(static_cast<std::size_t>(place), samples.size() - 1),
                    after = std::min(before + 1, samples.size() - 1);
  const double share = place - static_cast<double>(before);
  return (1.0 - share) * samples[before][vertex] + share * samples[after][vertex];
}

void MeshSolid::positions(double time, std::span<Vec3> x) const {
  const Pose pose = solid_.pose(time);
  const Mat3 rotation = pose.rotation.toRotationMatrix();
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = rotation * local(k, time) + pose.translation;
}

}  // namespace taut
