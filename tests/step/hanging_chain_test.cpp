// A chain of masses and springs between two pins comes to rest in the discrete catenary, which is
// known in closed form but for one number.
//
//   spring s, s = 0 ... n-1, carries the horizontal tension H and the vertical one V_s = m g (s -
//   (n-1)/2)
//   T_s = sqrt(H² + V_s²), length L0 + T_s/k, direction (H, V_s)/T_s;  H such that the horizontal
//   parts of all lengths add up to the span

#include <gtest/gtest.h>

#include <cmath>

#include "step/small_system.h"

namespace taut {
namespace {

constexpr Index links = 12;
constexpr double mass = 0.02, stiffness = 200.0, rest_length = 0.1, span = 0.9, g = 9.81;

std::vector<Vec3> catenary() {
  const auto places = [](double tension) {
    std::vector<Vec3> x{Vec3::Zero()};
    for (Index s = 0; s < links; ++s) {
      const Vec3 force(tension, 0.0, mass * g * (s - 0.5 * (links - 1)));
      x.push_back(x.back() + (rest_length / force.norm() + 1.0 / stiffness) * force);
    }
    return x;
  };
  double low = 1e-9, high = 100.0;
  for (int i = 0; i < 200; ++i)
    (places(0.5 * (low + high)).back().x() < span ? low : high) = 0.5 * (low + high);
  return places(low);
}

test::SmallSystem chain(SpringLawKind law) {
  test::SmallSystem system;
  system.gravity = Vec3(0, 0, -g);
  std::vector<Spring> springs;
  for (Index i = 0; i <= links; ++i) {
    system.add_node(mass, Vec3(span * i / links, 0.001 * (i % 3), 0.0));
    if (i > 0)
      springs.push_back(
          {i - 1, i, {.rest_length = rest_length, .stiffness = stiffness, .damping = 0.3}});
  }
  for (const Index end : {Index{0}, links}) system.state.x[end].y() = 0.0;
  system.drag = 0.08;
  system.add_springs(ForceClass::stretch, law, springs);
  return system;
}

TEST(HangingChain, SettlesToTheDiscreteCatenary) {
  const std::vector<Vec3> expected = catenary();
  ASSERT_NEAR(expected.back().z(), 0.0, 1e-12);
  ASSERT_LT(expected[links / 2].z(), -0.3) << "slack enough to hang down";
  for (const IntegratorKind kind : test::all_integrators)
    for (const SpringLawKind law : {SpringLawKind::linear, SpringLawKind::buckling}) {
      test::SmallSystem system = chain(law);
      system.start(kind);
      system.pin(0);
      system.pin(links);
      system.run(0.01, 3000);
      for (Index i = 0; i <= links; ++i)
        EXPECT_LT((system.state.x[i] - expected[i]).norm(), 1e-6)
            << name_of(kind) << ", node " << i;
      // Half of the weight hangs on either pin (h times the force is the impulse), and the chain
      // pulls with H inwards.
      const Vec3 force = system.stepper->constraint_impulse()[0] / 0.01;
      EXPECT_NEAR(force.z(), 0.5 * (links + 1) * mass * g, 1e-4);
      const double tension = stiffness * ((expected[1] - expected[0]).norm() - rest_length) *
                             expected[1].normalized().x();
      EXPECT_NEAR(force.x(), -tension, 1e-4);
    }
}

}  // namespace
}  // namespace taut
