#pragma once
// Rigid motions of a set of nodes over one step (docs/mathematics.md, 7.6):
//
//   x1 = to + R (x0 - from)
//   momentum_keeping   from and to are the centres of mass before and after, and R solves
//                      sum m r × R r = sum m r × (x1 - to),   r = x0 - from
//
// so that the average velocities (x1 - x0)/h have the linear and angular momentum that they had
// (about any point), to rounding: the discrete rigid body (Moser & Veselov 1991). Bridson et al.
// 2002 turn by ω h with I ω = L, which keeps it to first order in the angle only. There is no
// solution beyond about 90°: R is then the turn by ω h, cut at one radian, and `exact` is false.
//
// Interpolated linearly, a rigid motion by less than 180° is an affine map with an inverse at every
// t: points of the set never meet on the way, and their distances shrink by cos(angle/2) at most.

#include <optional>
#include <span>

#include "taut/base/types.h"

namespace taut {

struct RigidMotion {
  Mat3 rotation = Mat3::Identity();
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  bool exact = true;
  Vec3 operator()(const Vec3& x0) const { return to + rotation * (x0 - from); }
  double angle() const;  // rad
};

// x0, x1: m; mass: kg, > 0; one each a node.
RigidMotion momentum_keeping_motion(std::span<const Vec3> x0, std::span<const Vec3> x1,
                                    std::span<const double> mass);

// The rigid motion that takes x0 to x1, to within `tolerance` (m); the least turn where the points
// leave it open (one point, or points on a line). Nothing where there is none, or it turns by more
// than one radian.
std::optional<RigidMotion> motion_through(std::span<const Vec3> x0, std::span<const Vec3> x1,
                                          double tolerance);

}  // namespace taut
