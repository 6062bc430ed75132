#include "taut/contact/solid_obstacles.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace taut {

SolidObstacles::SolidObstacles(std::vector<Solid> solids, Index nodes, double touch_tolerance,
                               std::vector<std::vector<std::uint8_t>> meets)
    : solids_(std::move(solids)),
      nodes_(nodes),
      touch_tolerance_(touch_tolerance),
      meets_(std::move(meets)) {
  meets_.resize(solids_.size());
}

void SolidObstacles::set_motion(std::size_t k, const Solid& solid) {
  assert(k < solids_.size());
  Solid& own = solids_[k];
  assert(own.shape == solid.shape && own.radius == solid.radius && own.height == solid.height &&
         own.size == solid.size);
  own.key_frames = solid.key_frames;
  own.initial = solid.initial;
  own.velocity = solid.velocity;
  own.angular_velocity = solid.angular_velocity;
}

void SolidObstacles::begin_step(double t, double h, std::span<const Vec3> start) {
  assert(std::ssize(start) == nodes_ && h > 0.0);
  start_.assign(start.begin(), start.end());
  steps_.clear();
  for (const Solid& solid : solids_) steps_.emplace_back(solid, t, h);
}

double SolidObstacles::depth_tolerance(Index solid) const {
  return std::max(touch_tolerance_, step(solid).floating_tolerance());
}

bool SolidObstacles::in_the_way(Index node, Index solid, const Vec3& x_end) const {
  return may_meet(solid, node) && step(solid).meets(start_[node], x_end, -depth_tolerance(solid));
}

LandingPlane SolidObstacles::landing(Index node, Index solid, const Vec3& x_end) const {
  const SolidStep& over = step(solid);
  return over.landing(x_end, over.anchor(start_[node], x_end, touch_tolerance_));
}

Obstacle SolidObstacles::obstacle(Index node, Index solid, const Vec3& x_end) const {
  const LandingPlane plane = landing(node, solid, x_end);
  return {solid, plane.normal, plane.normal.dot(x_end) - plane.gap,
          step(solid).carried_from(start_[node]), step(solid).friction()};
}

std::optional<Obstacle> SolidObstacles::obstacle(Index node, const Vec3& x_end) const {
  for (Index s = 0; s < std::ssize(steps_); ++s)
    if (in_the_way(node, s, x_end)) return obstacle(node, s, x_end);
  return {};
}

std::optional<double> SolidObstacles::move_out(Index node, Vec3& x_end) const {
  std::optional<double> depth;
  for (Index s = 0; s < std::ssize(steps_); ++s) {
    if (!in_the_way(node, s, x_end)) continue;
    const LandingPlane plane = landing(node, s, x_end);
    depth = std::max(depth.value_or(0.0), -plane.gap);
    x_end -= plane.gap * plane.normal;
  }
  return depth;
}

}  // namespace taut
