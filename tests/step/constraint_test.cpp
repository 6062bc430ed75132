// Pins: the force they bear, the paths they follow, and BDF2 after a correction by contact.

#include <gtest/gtest.h>

#include <cmath>

#include "step/small_system.h"

namespace taut {
namespace {

constexpr double m0 = 0.3, m1 = 0.8, stiffness = 500.0, rest = 0.4, g = 9.81;

// A weight on a spring under a pin, at its equilibrium.
test::SmallSystem hanging_weight() {
  test::SmallSystem system;
  system.gravity = Vec3(0, 0, -g);
  system.add_node(m0, Vec3::Zero());
  system.add_node(m1, Vec3(0, 0, -(rest + m1 * g / stiffness)));
  system.add_springs(ForceClass::stretch, SpringLawKind::buckling,
                     {{0, 1, {.rest_length = rest, .stiffness = stiffness, .damping = 2.0}}});
  return system;
}

TEST(ConstraintImpulse, IsTheWeightTimesTheStep) {
  for (const IntegratorKind kind : test::all_integrators)
    for (const double h : {0.001, 0.02}) {
      test::SmallSystem system = hanging_weight();
      system.start(kind);
      system.pin(0);
      for (int n = 0; n < 5; ++n) {
        system.step(h);
        const Vec3 j = system.stepper->constraint_impulse()[0];
        ASSERT_LT((j - h * (m0 + m1) * g * Vec3::UnitZ()).norm(), 1e-11)
            << name_of(kind) << ", h = " << h << ", step " << n;
        ASSERT_EQ(system.stepper->constraint_impulse()[1], Vec3(Vec3::Zero()));
      }
      EXPECT_LT(system.state.v[1].norm(), 1e-11);
    }
}

// Held along z only: the impulse has no part in the free directions.
TEST(ConstraintImpulse, LiesInTheConstrainedDirections) {
  for (const IntegratorKind kind : test::all_integrators) {
    test::SmallSystem system;
    system.gravity = Vec3(2, 0, -g);
    system.add_node(m0, Vec3::Zero());
    system.start(kind);
    const Vec3 n = Vec3(0.6, 0.0, 0.8);
    system.constraints.constrain(0, n, 0.0);
    for (int k = 1; k <= 6; ++k) {
      system.step(0.01);
      const Vec3 j = system.stepper->constraint_impulse()[0];
      ASSERT_LT((j + 0.01 * m0 * n.dot(system.gravity) * n).norm(), 1e-14) << name_of(kind);
      const Vec3 along = system.gravity - n.dot(system.gravity) * n;
      ASSERT_LT((system.state.v[0] - 0.01 * k * along).norm(), 1e-13)
          << name_of(kind) << ": slides down the incline";
    }
  }
}

// An outside impulse on a node, given to solve() in every step, acts as the force j/h.
TEST(ConstraintImpulse, OutsideImpulsesActAsForces) {
  for (const IntegratorKind kind : test::all_integrators) {
    test::SmallSystem pushed, heavy;
    pushed.add_node(m0, Vec3::Zero());
    heavy.add_node(m0, Vec3::Zero());
    const double h = 0.01;
    const Vec3 force(0.1, -0.7, 0.4);
    heavy.gravity = force / m0;
    pushed.start(kind);
    heavy.start(kind);
    const std::vector<Vec3> impulses{h * force};
    for (int n = 0; n < 10; ++n) {
      heavy.step(h);
      pushed.stepper->begin(pushed.state, h);
      ASSERT_TRUE(pushed.stepper->solve(pushed.constraints, impulses).status.ok());
      pushed.stepper->commit(pushed.state);
      ASSERT_LT((pushed.state.x[0] - heavy.state.x[0]).norm(), 1e-15)
          << name_of(kind) << ", step " << n;
      ASSERT_LT((pushed.state.v[0] - heavy.state.v[0]).norm(), 1e-13)
          << name_of(kind) << ", step " << n;
    }
  }
}

TEST(PrescribedMotion, PositionsAreThePathsInAllIntegrators) {
  const auto path = [](double t) {
    return Vec3(std::sin(3.0 * t), 0.5 - 0.5 * std::cos(5.0 * t), t * t);
  };
  for (const IntegratorKind kind : test::all_integrators) {
    test::SmallSystem system = hanging_weight();
    system.start(kind);
    const double h = 0.01;
    Vec3 last_velocity = Vec3::Zero();
    for (int n = 0; n < 200; ++n) {
      const Vec3 target = path((n + 1) * h), start = system.state.x[0],
                 before = n > 0 ? system.state.x_prev[0] : start;
      system.constraints.reset(2);
      system.pin(0, target - start);
      system.step(h);
      ASSERT_LT((system.state.x[0] - target).norm(), 1e-13) << name_of(kind) << ", step " << n;
      const bool multistep = kind == IntegratorKind::bdf2 && n > 0;
      const Vec3 velocity = multistep ? Vec3((3.0 * target - 4.0 * start + before) / (2.0 * h))
                                      : Vec3((target - start) / h);
      ASSERT_LT((system.state.v[0] - velocity).norm(), 1e-11) << name_of(kind) << ", step " << n;
      last_velocity = system.state.v[0];
    }
    // And the velocity is the path's: to first or second order.
    const double t = 200 * h;
    const Vec3 exact(3.0 * std::cos(3.0 * t), 2.5 * std::sin(5.0 * t), 2.0 * t);
    EXPECT_LT((last_velocity - exact).norm(), kind == IntegratorKind::bdf2 ? 0.006 : 0.1);
  }
}

// A node held in one direction and moved along it keeps its other two free.
TEST(PrescribedMotion, FreeDirectionsStayFree) {
  for (const IntegratorKind kind : test::all_integrators) {
    test::SmallSystem system;
    system.add_node(m0, Vec3::Zero(), Vec3(1, 2, 0));
    system.start(kind);
    for (int n = 0; n < 20; ++n) {
      system.constraints.reset(1);
      system.constraints.constrain(0, Vec3::UnitZ(), 0.01 * (n + 1));
      system.step(0.1);
    }
    EXPECT_LT((system.state.x[0] - Vec3(2.0, 4.0, 0.01 * 210)).norm(), 1e-13) << name_of(kind);
    EXPECT_LT((system.state.v[0].head<2>() - Vec2(1, 2)).norm(), 1e-13) << name_of(kind);
  }
}

TEST(Bdf2, StepAfterACorrectionIsOneOfEuler) {
  const double h = 0.02;
  test::SmallSystem bdf2 = hanging_weight(), euler = hanging_weight();
  bdf2.start(IntegratorKind::bdf2);
  euler.start(IntegratorKind::semi_implicit_euler);
  bdf2.state.v[1] = Vec3(1, 0, 2);
  bdf2.pin(0), euler.pin(0);
  bdf2.run(h, 3);
  EXPECT_EQ(bdf2.stepper->integrator().unknown(bdf2.state), "dx");

  bdf2.stepper->begin(bdf2.state, h);
  ASSERT_TRUE(bdf2.stepper->solve(bdf2.constraints, {}).status.ok());
  const Vec3 end = bdf2.stepper->x_end()[1], speed = bdf2.stepper->v_end()[1],
             moved(0.001, -0.002, 0.003);
  std::vector<Vec3> corrected(bdf2.stepper->x_end().begin(), bdf2.stepper->x_end().end());
  corrected[1] += moved;
  bdf2.stepper->commit(bdf2.state);
  bdf2.stepper->correct(bdf2.state, corrected, bdf2.stepper->h());
  EXPECT_EQ(bdf2.state.x[1], corrected[1]);
  EXPECT_LT((bdf2.state.v[1] - speed - moved / h).norm(), 1e-12);
  EXPECT_LT((bdf2.state.x[1] - end - moved).norm(), 1e-15);
  EXPECT_EQ(bdf2.stepper->integrator().unknown(bdf2.state), "dv");
  EXPECT_TRUE(bdf2.state.last.empty()) << "a displacement is no guess for a velocity change";

  euler.state = bdf2.state;
  euler.step(h);
  bdf2.step(h);
  EXPECT_TRUE(bdf2.state.x == euler.state.x && bdf2.state.v == euler.state.v)
      << "the same bits as Euler's";
  EXPECT_EQ(bdf2.stepper->integrator().unknown(bdf2.state), "dx");
  EXPECT_TRUE(bdf2.state.last.empty());
}

}  // namespace
}  // namespace taut
