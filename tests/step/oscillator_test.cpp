// Two masses on a spring: linear, so that each integrator has a closed form; and the closed form of
// the motion itself as h -> 0.
//
//   s = elongation of the axis, s' = r:  s' = r, r' = -ω² s - 2γ r,   ω² = k (1/m1 + 1/m2), 2γ =
//   k_d (1/m1 + 1/m2)

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "step/small_system.h"

namespace taut {
namespace {

constexpr double m1 = 0.2, m2 = 0.5, stiffness = 30.0, rest = 1.0, elongation = 0.1;
const double inverse_mass = 1.0 / m1 + 1.0 / m2, omega = std::sqrt(stiffness * inverse_mass);

test::SmallSystem dumbbell(double damping) {
  test::SmallSystem system;
  const Vec3 axis = Vec3(2, 1, -2) / 3.0;
  system.add_node(m1, Vec3::Zero());
  system.add_node(m2, (rest + elongation) * axis);
  system.add_springs(ForceClass::stretch, SpringLawKind::linear,
                     {{0, 1, {.rest_length = rest, .stiffness = stiffness, .damping = damping}}});
  return system;
}

Vec2 axial(const test::SmallSystem& system) {
  const Vec3 d = system.state.x[1] - system.state.x[0];
  return {d.norm() - rest, d.normalized().dot(system.state.v[1] - system.state.v[0])};
}

// Backward Euler's y_n+1 = (I - hJ)⁻¹ y_n and BDF2's (3I - 2hJ) y_n+1 = 4 y_n - y_n-1, begun with a
// step of Euler.
TEST(Oscillator, FollowsTheClosedFormOfTheIntegrator) {
  for (const double damping : {0.0, 0.3})
    for (const IntegratorKind kind : test::all_integrators) {
      Eigen::Matrix2d j;
      j << 0.0, 1.0, -omega * omega, -damping * inverse_mass;
      const double h = 0.03;
      const Eigen::Matrix2d identity = Eigen::Matrix2d::Identity();
      test::SmallSystem system = dumbbell(damping);
      system.start(kind);
      Vec2 before(elongation, 0.0), now = (identity - h * j).inverse() * before;
      for (int n = 1; n <= 100; ++n) {
        system.step(h);
        ASSERT_LT((axial(system) - now).norm(), 1e-11)
            << name_of(kind) << ", damping " << damping << ", step " << n;
        const Vec2 next =
            kind == IntegratorKind::bdf2
                ? Vec2((3.0 * identity - 2.0 * h * j).inverse() * (4.0 * now - before))
                : Vec2((identity - h * j).inverse() * now);
        before = std::exchange(now, next);
      }
    }
}

// Time of the third upward crossing of zero by linear interpolation: 2.75 periods when it starts
// stretched and at rest.
double measured_period(IntegratorKind kind, double h) {
  test::SmallSystem system = dumbbell(0.0);
  system.start(kind);
  int crossings = 0;
  double last = elongation;
  for (int n = 1; n < 200000; ++n) {
    system.step(h);
    const double now = axial(system)[0];
    if (last < 0.0 && now >= 0.0 && ++crossings == 3) return h * (n - now / (now - last)) / 2.75;
    last = now;
  }
  ADD_FAILURE() << "no oscillation";
  return 0.0;
}

TEST(Oscillator, PeriodIsTwoPiOverOmegaInTheLimit) {
  const double period = 2.0 * std::numbers::pi / omega;
  // Backward Euler turns atan(hω) a step, BDF2 hω (1 + O(hω)²); their first quarter-turns differ by
  // parts of a step.
  const double h = period / 2000.0;
  EXPECT_NEAR(measured_period(IntegratorKind::semi_implicit_euler, h) / period, 1.0, 1e-4);
  EXPECT_NEAR(measured_period(IntegratorKind::bdf2, h) / period, 1.0, 1e-4);
}

TEST(Oscillator, DampingIsTheClosedFormInTheLimit) {
  const double damping = 0.2, gamma = 0.5 * damping * inverse_mass,
               turning = std::sqrt(omega * omega - gamma * gamma), t = 0.5;
  const double exact = elongation * std::exp(-gamma * t) *
                       (std::cos(turning * t) + gamma / turning * std::sin(turning * t));
  const auto error = [&](IntegratorKind kind, int steps) {
    test::SmallSystem system = dumbbell(damping);
    system.start(kind);
    system.run(t / steps, steps);
    return std::abs(axial(system)[0] - exact);
  };
  EXPECT_NEAR(std::log2(error(IntegratorKind::semi_implicit_euler, 1000) /
                        error(IntegratorKind::semi_implicit_euler, 2000)),
              1.0, 0.1);
  EXPECT_NEAR(std::log2(error(IntegratorKind::bdf2, 200) / error(IntegratorKind::bdf2, 400)), 2.0,
              0.15);
  EXPECT_LT(error(IntegratorKind::bdf2, 2000), 3e-5 * elongation);
}

}  // namespace
}  // namespace taut
