#pragma once
// Free point masses under gravity, stepped by semi-implicit Euler with A = M: the smallest
// integrator that contact can be tested with.
//   dv = S (b + f) / m + (I - S)(d / h - v),   b = h m g,   f = friction impulse,   j = (I - S)(m
//   dv - b)

#include <gtest/gtest.h>

#include "taut/contact/solid_contact.h"

namespace taut::test {

struct PointMasses {
  std::vector<Vec3> x, v;
  double mass = 0.01;  // kg
  Vec3 gravity = Vec3(0, 0, -9.81);
  double t = 0.0;
  ConstraintSet pins;
  ConstraintSet constraints;      // of the last pass
  std::vector<Vec3> j, friction;  // of the last pass
  int most_passes = 0;

  explicit PointMasses(std::vector<Vec3> start, const Vec3& velocity = Vec3::Zero())
      : x(std::move(start)), v(x.size(), velocity), pins(static_cast<Index>(x.size())) {}

  Index nodes() const { return static_cast<Index>(x.size()); }

  void step(SolidContact& contact, double h) {
    std::vector<Vec3> predicted(x.size()), end(x.size()), dv(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) predicted[i] = x[i] + h * v[i];
    contact.begin_step(t, h, x, predicted, pins);
    do {
      constraints = pins;
      contact.constrain(constraints);
      friction.assign(x.size(), Vec3::Zero());
      if (!contact.impulses().empty())
        friction.assign(contact.impulses().begin(), contact.impulses().end());
      j.assign(x.size(), Vec3::Zero());
      for (Index i = 0; i < nodes(); ++i) {
        const Vec3 b = h * mass * gravity;
        const Vec3 prescribed =
            constraints.displacement(i) / h - constraints.constrained_part(i, v[i]);
        dv[i] = constraints.free_part(i, b + friction[i]) / mass + prescribed;
        j[i] = constraints.constrained_part(i, mass * dv[i] - b);
        end[i] = x[i] + h * (v[i] + dv[i]);
      }
    } while (contact.update(end, j));
    most_passes = std::max(most_passes, contact.passes());
    contact.finish(end);
    for (std::size_t i = 0; i < x.size(); ++i) v[i] += dv[i];
    x = end;
    t += h;
  }
  void run(SolidContact& contact, double h, int steps) {
    for (int k = 0; k < steps; ++k) step(contact, h);
  }
};

inline Solid plane(const Vec3& normal, double friction = 0.0, const Vec3& origin = Vec3::Zero()) {
  Solid solid;
  solid.shape = SolidShape::plane;
  solid.friction = friction;
  solid.initial.translation = origin;
  solid.initial.rotation = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal.normalized());
  return solid;
}

inline Solid sphere(double radius, double friction = 0.0, const Vec3& centre = Vec3::Zero()) {
  Solid solid;
  solid.shape = SolidShape::sphere;
  solid.radius = radius;
  solid.friction = friction;
  solid.initial.translation = centre;
  return solid;
}

inline Solid box(const Vec3& size, double friction = 0.0) {
  Solid solid;
  solid.shape = SolidShape::box;
  solid.size = size;
  solid.friction = friction;
  return solid;
}

inline Solid cylinder(double radius, double height, double friction = 0.0) {
  Solid solid;
  solid.shape = SolidShape::cylinder;
  solid.radius = radius;
  solid.height = height;
  solid.friction = friction;
  return solid;
}

inline double gap_of(const Solid& solid, double t, const Vec3& x) {
  return closest_surface(solid, solid.pose(t).to_local(x)).distance - solid.thickness;
}

}  // namespace taut::test
