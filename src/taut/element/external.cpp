#include "taut/element/external.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "taut/base/parallel.h"

namespace taut {

Vec3 WindOptions::at(double time) const {
  return velocity * (1.0 + gust * std::sin(2.0 * std::numbers::pi * gust_frequency * time));
}

ExternalForces::ExternalForces(std::vector<double> masses, Vec3 gravity, WindOptions wind)
    : masses_(std::move(masses)),
      drag_(masses_.size(), 0.0),
      gravity_(gravity),
      wind_(wind),
      force_(masses_.size()) {}

void ExternalForces::add_wind_surface(std::span<const Triangle> triangles, double pressure) {
  if (pressure > 0.0) surfaces_.push_back({{triangles.begin(), triangles.end()}, pressure});
}

void ExternalForces::evaluate(double time, std::span<const Vec3> x, std::span<const Vec3> v) {
  const bool damped =
      !surfaces_.empty() || std::ranges::any_of(drag_, [](double c) { return c > 0.0; });
  const Vec3 wind = wind_.at(time);
  const Index n = static_cast<Index>(masses_.size());
  damping_.resize(damped ? masses_.size() : 0);
  if (damped)
    parallel_for(n, 4096, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) damping_[i] = drag_[i] * Mat3::Identity();
    });
  for (const Surface& surface : surfaces_)
    for (const Triangle& t : surface.triangles) {
      const Vec3 doubled = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);  // 2 A n
      const double twice_area = doubled.norm();
      if (twice_area == 0.0) continue;
      // scaled afterwards: symmetric to the last bit, as A must be
      const Mat3 outer = doubled * doubled.transpose();
      const Mat3 share = surface.pressure / (6.0 * twice_area) * outer;
      for (const Index node : t) damping_[node] += share;
    }
  parallel_for(n, 4096, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      force_[i] = masses_[i] * gravity_;
      if (damped) force_[i] += damping_[i] * (wind - v[i]);
      if (!applied_.empty()) force_[i] += applied_[i];
    }
  });
}

}  // namespace taut
