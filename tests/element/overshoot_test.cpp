// What a linearised step does not foresee about a spring's length, against cases worked out by
// hand.

#include "taut/element/overshoot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace taut {
namespace {

const SpringParameters unit{.rest_length = 1.0, .stiffness = 10.0};

TEST(Overshoot, TurningIsNotForeseen) {
  // A quarter circle's worth of straight motion: the end lies at (1, 1), its share along the old
  // direction is 1.
  EXPECT_NEAR(spring_overshoot(SpringLawKind::linear, unit, Vec3(1, 0, 0), Vec3(1, 1, 0)),
              std::sqrt(2.0) - 1.0, 1e-15);
  // Halving the angle leaves about a quarter: the error is of second order.
  const double whole =
      spring_overshoot(SpringLawKind::linear, unit, Vec3(1, 0, 0), Vec3(1, 0.2, 0));
  const double half = spring_overshoot(SpringLawKind::linear, unit, Vec3(1, 0, 0), Vec3(1, 0.1, 0));
  EXPECT_NEAR(whole / half, 4.0, 0.05);
}

TEST(Overshoot, StretchingAlongTheSpringIsForeseen) {
  for (const SpringLawKind law : {SpringLawKind::linear, SpringLawKind::buckling})
    EXPECT_EQ(spring_overshoot(law, unit, Vec3(0, 1, 0), Vec3(0, 1.7, 0)), 0.0);
}

TEST(Overshoot, ASlackSpringHadNoStiffness) {
  const Vec3 slack(0.5, 0, 0), taut(1.2, 0, 0);
  EXPECT_NEAR(spring_overshoot(SpringLawKind::buckling, unit, slack, taut), 0.2, 1e-15);
  EXPECT_EQ(spring_overshoot(SpringLawKind::linear, unit, slack, taut), 0.0);
  EXPECT_EQ(spring_overshoot(SpringLawKind::buckling, unit, slack, Vec3(0.99, 0, 0)), 0.0);
}

TEST(Overshoot, CompressedAtTheEndIsNoOvershoot) {
  EXPECT_EQ(spring_overshoot(SpringLawKind::linear, unit, Vec3(1, 0, 0), Vec3(0, 0.9, 0)), 0.0);
}

TEST(Overshoot, ACollapsedSpringHasNoDirection) {
  EXPECT_NEAR(spring_overshoot(SpringLawKind::linear, unit, Vec3::Zero(), Vec3(0, 1.5, 0)), 0.5,
              1e-15);
}

TEST(Overshoot, TheLargestOfAModelAndNanIsWorst) {
  std::vector<Spring> springs{{0, 1, unit}, {1, 2, unit}};
  const SpringModel model(ForceClass::stretch, SpringLawKind::linear, springs);
  const std::vector<Vec3> start{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  std::vector<Vec3> end{{0, 0, 0}, {1, 0.1, 0}, {2, 1, 0}};
  EXPECT_NEAR(largest_overshoot(model, start, end), std::sqrt(1 + 0.81) - 1, 1e-15);
  end[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(std::isfinite(largest_overshoot(model, start, end)));
}

}  // namespace
}  // namespace taut
