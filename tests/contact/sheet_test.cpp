#include <algorithm>
#include <numeric>

#include "contact/point_masses.h"
#include "contact/spring_sheet.h"

namespace taut {
namespace {

using test::SpringSheet;

double mean_passes(const SpringSheet& sheet) {
  return std::accumulate(sheet.passes.begin(), sheet.passes.end(), 0.0) / sheet.passes.size();
}

// The paper's Figure 3 in small: a sheet hung by two corners, hit by a ball of radius 0.2 m at 3
// m/s.
class HitSheet : public testing::TestWithParam<double> {};

TEST_P(HitSheet, isNeverInsideTheBall) {
  const Index side = 21;
  SpringSheet sheet(side, GetParam(),
                    [](double u, double w) { return Vec3(u - 0.5, 0.0, w - 0.5); });
  sheet.pins.fix(sheet.node(side - 1, 0), Vec3::Zero());
  sheet.pins.fix(sheet.node(side - 1, side - 1), Vec3::Zero());
  Solid ball = test::sphere(0.2, 0.3, Vec3(0.0, -0.27, 0.0));
  ball.velocity = Vec3(0, 3, 0);
  SolidContact contact({ball}, side * side, {});
  int touches = 0, moved = 0;
  for (int k = 0; k < 40; ++k) {
    sheet.step(contact, 6.67e-3);
    touches = std::max(touches, contact.contacts());
    moved += contact.counts().moved;
    for (const Vec3& x : sheet.x)
      ASSERT_GT(test::gap_of(ball, sheet.t, x), -2.5e-4 * ball.radius) << "step " << k;
  }
  EXPECT_GT(touches, 20);
  EXPECT_LE(moved, 2);  // of 40 steps: at the pass limit a node may still be inside, and is moved
  EXPECT_GT(sheet.x[sheet.node(side / 2, side / 2)].y(), ball.radius);
  EXPECT_LT(mean_passes(sheet), 5.5);
}

INSTANTIATE_TEST_SUITE_P(bothEndsOfStiffness, HitSheet, testing::Values(60.0, 6000.0));

TEST(DrapedSheet, restsOnABallWhoseFrictionHolds) {
  const Index side = 15;
  SpringSheet sheet(
      side, 60.0, [](double u, double w) { return Vec3(0.6 * (u - 0.5), 0.6 * (w - 0.5), 0.21); });
  sheet.drag = 1e-4;
  const Solid ball = test::sphere(0.2, 2.0);
  SolidContact contact({ball}, side * side, {});
  for (int k = 0; k < 300; ++k) {
    sheet.step(contact, 5e-3);
    for (const Vec3& x : sheet.x)
      ASSERT_GT(test::gap_of(ball, sheet.t, x), -2.5e-4 * ball.radius) << "step " << k;
  }
  // Most of what touches is held, it does not slip off, and the last steps need little.
  EXPECT_GT(contact.contacts(), 100);
  EXPECT_GT(contact.sticking(), 0.9 * contact.contacts());
  EXPECT_LT(sheet.x[sheet.node(side / 2, side / 2)].head<2>().norm(), 0.01);
  const double last = std::accumulate(sheet.passes.end() - 50, sheet.passes.end(), 0.0) / 50;
  EXPECT_LT(last, 2.5);
}

}  // namespace
}  // namespace taut
