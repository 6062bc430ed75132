// Motion without outside contact: free fall, drag, and what becomes of momentum.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "step/small_system.h"

namespace taut {
namespace {

const Vec3 gravity(1.0, -2.0, -9.81);
const Vec3 place(0.3, 0.7, 2.0), speed(3.0, 0.1, -1.0);

test::SmallSystem falling() {
  test::SmallSystem system;
  system.gravity = gravity;
  system.add_node(0.01, place, speed);
  system.add_node(0.7, place + Vec3(1, 0, 0), speed);
  // At rest while both fall alike.
  system.add_springs(ForceClass::stretch, SpringLawKind::linear,
                     {{0, 1, {.rest_length = 1.0, .stiffness = 300.0, .damping = 1.0}}});
  return system;
}

// x_n = x_0 + n h v_0 + h² g n(n+1)/2: semi-implicit Euler's parabola.
TEST(FreeFall, EulerAndImexAreTheirClosedForm) {
  for (const IntegratorKind kind : {IntegratorKind::semi_implicit_euler, IntegratorKind::imex}) {
    test::SmallSystem system = falling();
    system.start(kind);
    const double h = 0.01;
    const int n = 250;
    system.run(h, n);
    EXPECT_LT((system.state.v[0] - (speed + n * h * gravity)).norm(), 1e-12 * 25) << name_of(kind);
    EXPECT_LT((system.state.x[0] - (place + n * h * speed + 0.5 * h * h * n * (n + 1.0) * gravity))
                  .norm(),
              1e-12 * 40)
        << name_of(kind);
    EXPECT_LT((system.state.x[1] - system.state.x[0] - Vec3(1, 0, 0)).norm(), 1e-12 * 40);
    EXPECT_NEAR(system.state.time, n * h, 1e-12);
  }
}

// BDF2 is exact for a parabola but for what its first step, one of Euler, did: h²g/2 too far. The
// two-step formula carries an error e_1 on as e_n = (3/2) e_1 (1 - 3^-n).
TEST(FreeFall, Bdf2IsExactButForItsFirstStep) {
  test::SmallSystem system = falling();
  system.start(IntegratorKind::bdf2);
  const double h = 0.01;
  for (int n = 1; n <= 250; ++n) {
    system.step(h);
    const double t = n * h;
    const Vec3 exact = place + t * speed + 0.5 * t * t * gravity;
    const Vec3 error = 0.75 * h * h * gravity * (1.0 - std::pow(3.0, -n));
    ASSERT_LT((system.state.v[0] - (speed + t * gravity)).norm(), 1e-11);
    ASSERT_LT((system.state.x[0] - exact - error).norm(), 1e-11) << "step " << n;
  }
}

TEST(FreeFall, Bdf2WithAPastIsExact) {
  test::SmallSystem system = falling();
  system.start(IntegratorKind::bdf2);
  const double h = 0.01;
  for (std::size_t i = 0; i < 2; ++i) {
    system.state.x_prev.push_back(system.state.x[i] - h * speed + 0.5 * h * h * gravity);
    system.state.v_prev.push_back(speed - h * gravity);
  }
  system.state.has_previous = true;
  system.run(h, 250);
  EXPECT_LT((system.state.x[0] - (place + 2.5 * speed + 0.5 * 6.25 * gravity)).norm(), 1e-11);
  EXPECT_LT((system.state.v[0] - (speed + 2.5 * gravity)).norm(), 1e-11);
}

// m dv/dt = -c v: Euler divides by 1 + h c/m a step; BDF2 follows its recurrence.
TEST(FreeMotion, DragIsImplicit) {
  const double h = 0.05, mass = 0.2, drag = 1.5, a = h * drag / mass;
  for (const IntegratorKind kind : test::all_integrators) {
    test::SmallSystem system;
    system.drag = drag;
    system.add_node(mass, Vec3::Zero(), speed);
    system.start(kind);
    double before = 1.0, now = 1.0 / (1.0 + a);
    for (int n = 1; n <= 20; ++n) {
      system.step(h);
      ASSERT_LT((system.state.v[0] - now * speed).norm(), 1e-13) << name_of(kind) << ", step " << n;
      const double next =
          kind == IntegratorKind::bdf2 ? (4.0 * now - before) / (3.0 + 2.0 * a) : now / (1.0 + a);
      before = std::exchange(now, next);
    }
  }
}

// A tumbling tetrahedron of springs, all stretched a little by its rotation.
test::SmallSystem tumbling(ForceClass force_class, SpringLawKind law, double rest_share,
                           double damping = 0.05) {
  test::SmallSystem system;
  const std::array corners{Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1.2)};
  const Vec3 turning(2.0, -1.0, 3.0);
  for (int k = 0; k < 4; ++k)
    system.add_node(0.1 + 0.05 * k, corners[k], Vec3(0.5, 0, 1) + turning.cross(corners[k]));
  std::vector<Spring> springs;
  for (Index i = 0; i < 4; ++i)
    for (Index j = i + 1; j < 4; ++j)
      springs.push_back({i,
                         j,
                         {.rest_length = rest_share * (corners[j] - corners[i]).norm(),
                          .stiffness = 40.0,
                          .damping = damping}});
  system.add_springs(force_class, law, springs);
  return system;
}

TEST(Momentum, LinearIsConserved) {
  for (const IntegratorKind kind : test::all_integrators)
    for (const ForceClass force_class : {ForceClass::stretch, ForceClass::bend}) {
      test::SmallSystem system = tumbling(force_class, SpringLawKind::linear, 0.8);
      system.start(kind);
      const Vec3 before = system.momentum();
      system.run(0.005, 400);
      EXPECT_LT((system.momentum() - before).norm(), 1e-12 * before.norm()) << name_of(kind);
    }
}

// Explicit central forces and x += h v: Σ x × f = 0 at the same x, so angular momentum is kept
// exactly.
TEST(Momentum, AngularIsConservedByExplicitSprings) {
  test::SmallSystem system = tumbling(ForceClass::bend, SpringLawKind::linear, 0.8);
  system.start(IntegratorKind::imex);
  const Vec3 before = system.angular_momentum();
  system.run(0.005, 400);
  EXPECT_LT((system.angular_momentum() - before).norm(), 1e-12 * before.norm());
}

// Where all springs are compressed K_s = k e eᵀ has no transverse part, and the implicit force too
// points along the spring.
TEST(Momentum, AngularIsConservedInCompression) {
  test::SmallSystem system = tumbling(ForceClass::stretch, SpringLawKind::linear, 1.6);
  for (Vec3& v : system.state.v) v *= 0.05;
  system.start(IntegratorKind::semi_implicit_euler);
  const Vec3 before = system.angular_momentum();
  for (int n = 0; n < 5; ++n) {
    system.step(0.005);
    ASSERT_LT(largest_strain(*system.models[0], system.state.x), 0.0)
        << "compressed throughout, or the test says nothing";
  }
  EXPECT_LT((system.angular_momentum() - before).norm(), 1e-12 * before.norm());
}

// A stretched spring's K has the transverse part T/L (I - e eᵀ), whose force is not along the
// spring. It is all that semi-implicit Euler loses:
//   a step changes angular momentum by -h² Σ (T/L) d × (v_j - v_i), d and T of the step's start, v
//   of its end.
TEST(Momentum, AngularDriftOfEulerIsTheTransverseTerms) {
  test::SmallSystem system = tumbling(ForceClass::stretch, SpringLawKind::linear, 0.7);
  system.start(IntegratorKind::semi_implicit_euler);
  const double h = 0.01;
  double drifted = 0.0;
  for (int n = 0; n < 50; ++n) {
    const Vec3 before = system.angular_momentum();
    const std::vector<Vec3> x = system.state.x;
    system.step(h);
    Vec3 expected = Vec3::Zero();
    for (const auto& [i, j, p] : system.models[0]->springs()) {
      const Vec3 d = x[j] - x[i];
      const double tension = p.stiffness * (d.norm() - p.rest_length);
      expected -= h * h * std::max(0.0, tension / d.norm()) *
                  d.cross(system.state.v[j] - system.state.v[i]);
    }
    const Vec3 change = system.angular_momentum() - before;
    ASSERT_LT((change - expected).norm(), 1e-12 * before.norm()) << "step " << n;
    drifted += change.norm();
  }
  EXPECT_GT(drifted, 0.01 * system.angular_momentum().norm())
      << "no drift at all: the test says nothing";
}

// So it is conserved as h -> 0: to first order by Euler, to second by BDF2 when nothing is dropped
// from its Jacobian. Damping's change with x is, and costs the order.
TEST(Momentum, AngularDriftVanishesWithTheStep) {
  const auto order = [](IntegratorKind kind, double damping) {
    const auto drift = [&](int steps) {
      test::SmallSystem system = tumbling(ForceClass::stretch, SpringLawKind::linear, 0.4, damping);
      system.start(kind);
      const Vec3 before = system.angular_momentum();
      system.run(0.02 / steps, steps);
      const std::vector<double> strains = spring_strains(*system.models[0], system.state.x);
      EXPECT_GT(*std::ranges::min_element(strains), 0.0) << "compressed: more would be dropped";
      return (system.angular_momentum() - before).norm();
    };
    return std::log2(drift(100) / drift(200));
  };
  EXPECT_NEAR(order(IntegratorKind::semi_implicit_euler, 0.05), 1.0, 0.15);
  EXPECT_GE(order(IntegratorKind::bdf2, 0.0), 1.85);
  EXPECT_NEAR(order(IntegratorKind::bdf2, 0.5), 1.0, 0.2);
}

}  // namespace
}  // namespace taut
