// Implicit Euler by Newton's method: the momentum equation holds at the end of the step, checked
// with the readable form of the spring law, which the assembly does not use.

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <random>

#include "step/small_system.h"
#include "taut/step/newton.h"

namespace taut {
namespace {

// A grid of 4 x 4 masses with stretch springs, tumbling fast enough to turn by a radian in a step.
test::SmallSystem tumbling(SpringLawKind law, double damping, double drag) {
  test::SmallSystem system;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(-1, 1);
  std::vector<Spring> springs;
  const SpringParameters p{.rest_length = 0.1, .stiffness = 500.0, .damping = damping};
  for (Index j = 0; j < 4; ++j)
    for (Index i = 0; i < 4; ++i) {
      const Vec3 x(0.1 * i, 0.1 * j, 0.01 * share(random));
      system.add_node(
          0.01 + 0.002 * share(random), x,
          Vec3(0, 0, 50).cross(x) + 0.3 * Vec3(share(random), share(random), share(random)));
      const Index n = 4 * j + i;
      if (i > 0) springs.push_back({n - 1, n, p});
      if (j > 0) springs.push_back({n - 4, n, p});
    }
  system.gravity = Vec3(0, 0, -9.81);
  system.drag = drag;
  system.add_springs(ForceClass::stretch, law, springs);
  return system;
}

// h f(x_end, v_end) - M dv.
std::vector<Vec3> residual(const test::SmallSystem& system, const State& before, double h) {
  std::vector<Vec3> r(system.masses.size());
  const State& after = system.state;
  for (std::size_t i = 0; i < r.size(); ++i)
    r[i] = h * (system.masses[i] * system.gravity - system.drag * after.v[i]) -
           system.masses[i] * (after.v[i] - before.v[i]);
  for (const auto& model : system.models)
    for (const auto& [i, j, p] : model->springs()) {
      const Vec3 force =
          spring_response(model->law(), p, after.x[j] - after.x[i], after.v[j] - after.v[i]).force;
      r[i] += h * force;
      r[j] -= h * force;
    }
  return r;
}

TEST(Newton, TheMomentumEquationHoldsAtTheEndOfTheStep) {
  constexpr double h = 0.02;
  for (const SpringLawKind law : {SpringLawKind::linear, SpringLawKind::buckling}) {
    test::SmallSystem system = tumbling(law, 0.05, 0.02);
    system.newton = {.tolerance = 1e-10, .max_iterations = 200};
    system.start(IntegratorKind::newton);
    system.pin(0);
    for (int k = 0; k < 5; ++k) {
      const State before = system.state;
      system.step(h);
      EXPECT_GT(system.stepper->newton_iterations(), 1);
      const std::vector<Vec3> r = residual(system, before, h);
      for (std::size_t i = 1; i < r.size(); ++i)
        EXPECT_LT(r[i].norm(), 1e-9) << "step " << k << ", node " << i;
      EXPECT_LT((system.stepper->constraint_impulse()[0] + r[0]).norm(), 1e-9)
          << "the pin gives what is missing";
      EXPECT_EQ(system.state.x[0], before.x[0]);
    }
  }
}

// One linear solve leaves a residual of second order; it also stretches springs that only turn.
TEST(Newton, HoldsTogetherWhatOneLinearSolveTearsApart) {
  const auto worst = [](IntegratorKind kind) {
    test::SmallSystem system = tumbling(SpringLawKind::linear, 0.0, 0.0);
    system.start(kind);
    system.step(0.02);
    return largest_strain(*system.models[0], system.state.x);
  };
  EXPECT_GT(worst(IntegratorKind::semi_implicit_euler), 0.2);
  EXPECT_LT(worst(IntegratorKind::newton), 0.08);
}

TEST(Newton, KeepsLinearMomentum) {
  test::SmallSystem system = tumbling(SpringLawKind::buckling, 0.1, 0.0);
  system.gravity = Vec3::Zero();
  system.newton.tolerance = 1e-9;
  system.start(IntegratorKind::newton);
  const Vec3 momentum = system.momentum();
  for (int k = 0; k < 10; ++k) system.step(0.01);
  EXPECT_LT((system.momentum() - momentum).norm(), 1e-12);
}

TEST(Newton, SaysWhenItDoesNotGetThere) {
  test::SmallSystem system = tumbling(SpringLawKind::linear, 0.0, 0.0);
  system.newton = {.tolerance = 1e-12, .max_iterations = 2};
  system.start(IntegratorKind::newton);
  system.stepper->begin(system.state, 0.02);
  const SolveSummary summary = system.stepper->solve(system.constraints, {});
  EXPECT_EQ(summary.status.outcome, Outcome::max_iterations);
  EXPECT_NE(summary.status.message.find("after 2 of 2 iterations"), std::string::npos)
      << summary.status.message;
}

// The line search, on r(u) = -atan(u) in one unknown, for which plain Newton diverges from |u| >
// 1.39.
TEST(Newton, TheLineSearchConvergesWhereFullStepsDiverge) {
  std::vector<Vec3> u{Vec3(3, 0, 0)};
  double at = 0.0;
  const NewtonProblem problem{
      [&](std::span<const Vec3> x) { return std::abs(std::atan(at = x[0].x())); },
      [&](std::span<const Vec3> d) { return -std::atan(at) * d[0].x(); },
      [&](std::span<Vec3> x) {
        x[0].x() = at - std::atan(at) * (1 + at * at);
        return SolveSummary{};
      },
  };
  const NewtonSummary summary =
      newton(problem, {.tolerance = 1e-12, .max_iterations = 50}, 1.0, {}, u);
  EXPECT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_GT(summary.halvings, 0);
  EXPECT_LT(std::abs(u[0].x()), 1e-12);
}

}  // namespace
}  // namespace taut
