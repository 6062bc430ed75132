#include <algorithm>
#include <numeric>

#include "contact/point_masses.h"
#include "contact/spring_sheet.h"

namespace taut {
namespace {

using test::SpringSheet;

void count_passes(const SpringSheet& sheet) {
  std::vector<int> histogram(9);
  for (int p : sheet.passes) ++histogram[p];
  for (int k = 1; k < 9; ++k) std::printf("%d:%d ", k, histogram[k]);
  std::puts("");
}

// The paper's Figure 3 in small: a sheet hung by two corners, hit by a ball of radius 0.2 m at 3 m/s.
TEST(Sheet, hitByAFlyingBallIsNeverInsideIt) {
  for (const double stretch : {60.0, 6000.0}) {
    SpringSheet sheet(31, stretch, [](double u, double w) { return Vec3(u - 0.5, 0.0, w - 0.5); });
    sheet.pins.fix(sheet.node(30, 0), Vec3::Zero());
    sheet.pins.fix(sheet.node(30, 30), Vec3::Zero());
    Solid ball = test::sphere(0.2, 0.3, Vec3(0.0, -0.6, 0.0));
    ball.velocity = Vec3(0, 3, 0);
    SolidContact contact({ball}, 31 * 31, {});
    int touches = 0, moved = 0;
    for (int k = 0; k < 60; ++k) {
      sheet.step(contact, 6.67e-3);
      touches = std::max(touches, contact.contacts());
      moved += contact.counts().moved;
      std::printf("%d: contacts %d stick %d passes %d add %d rel %d s2s %d sls %d\n", k, contact.contacts(), contact.sticking(),
                  contact.passes(), contact.counts().added, contact.counts().released, contact.counts().stick_to_slide,
                  contact.counts().slide_to_stick);
      for (const Vec3& x : sheet.x) ASSERT_GT(test::gap_of(ball, sheet.t, x), -2e-6);
    }
    count_passes(sheet);
    EXPECT_GT(touches, 50);
    EXPECT_EQ(moved, 0);
    const double mean = std::accumulate(sheet.passes.begin(), sheet.passes.end(), 0.0) / sheet.passes.size();
    EXPECT_LT(mean, 3.5);
  }
}

TEST(Sheet, fallsOnABallWhoseFrictionHolds) {
  SpringSheet sheet(25, 600.0, [](double u, double w) { return Vec3(0.8 * (u - 0.5), 0.8 * (w - 0.5), 0.21); });
  const Solid ball = test::sphere(0.2, 0.8);
  SolidContact contact({ball}, 25 * 25, {});
  for (int k = 0; k < 150; ++k) {
    sheet.step(contact, 5e-3);
    std::printf("%d: contacts %d stick %d passes %d add %d rel %d s2s %d sls %d\n", k, contact.contacts(), contact.sticking(),
                contact.passes(), contact.counts().added, contact.counts().released, contact.counts().stick_to_slide,
                contact.counts().slide_to_stick);
    for (const Vec3& x : sheet.x) ASSERT_GT(test::gap_of(ball, sheet.t, x), -2e-6) << "step " << k;
  }
  count_passes(sheet);
  EXPECT_GT(contact.sticking(), 30);
  EXPECT_LT(sheet.x[sheet.node(12, 12)].head<2>().norm(), 0.02);  // it does not slip off
}

}  // namespace
}  // namespace taut
