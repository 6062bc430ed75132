#include "taut/contact/stick_slip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace taut {
namespace {

constexpr double h = 5e-3;

// A node on one solid that answers linearly: slip = free_slip + compliance * impulse.
struct Slider {
  Vec3 free_slip = Vec3(3e-4, -4e-4, 0.0);  // m
  double compliance = 0.5;                  // m/(N s)
  double hold = 1e-2;                       // N s
  StickSlip friction;

  std::vector<ContactSlip> slips(const Vec3& impulse) const {
    return {{hold, free_slip + compliance * impulse}};
  }
  std::vector<ContactSlip> slips() const { return slips(friction.impulse()); }
  void begin() { friction.begin(slips(Vec3::Zero()), free_slip.norm()); }
  void pass() {
    friction.begin_pass(hold);
    if (friction.sticks())
      friction.judge_stick(-free_slip / compliance, 0.0);
    else
      friction.judge_slide(slips(), 0);
  }
  // A whole step of a node that goes on from the one before.
  void step() {
    friction = StickSlip(friction.stick(), friction.force(hold, h), h);
    if (!friction.sticks()) friction.begin(slips(), free_slip.norm());
    for (int k = 0; k < 4; ++k) pass();
    friction.settle();
  }
};

TEST(StickSlip, beginsToStickWhereItHardlySlipsOnItsWay) {
  const double way = 0.02;
  for (const double share : {0.0, 0.005, 0.015, 1.0}) {
    StickSlip friction;
    const Vec3 slip = share * way * Vec3(0.6, 0.8, 0.0);
    friction.begin(std::vector<ContactSlip>{{2.0, slip}}, way);
    EXPECT_EQ(friction.sticks(), share < 0.01) << share;
    const Vec3 against = share == 0.0 ? Vec3(Vec3::Zero()) : Vec3(-1.2, -1.6, 0.0);
    EXPECT_LT((friction.impulse() - against).norm(), 1e-15);
  }
  // On two solids that part it rides with neither, or with one only.
  StickSlip friction;
  friction.begin(std::vector<ContactSlip>{{2.0, Vec3::Zero()}, {3.0, 0.01 * Vec3::UnitX()}}, way);
  EXPECT_FALSE(friction.sticks());
  EXPECT_EQ(friction.impulse(), -3.0 * Vec3::UnitX());
}

TEST(StickSlip, everyContactHoldsAgainstItsOwnSlip) {
  StickSlip friction;
  friction.begin(std::vector<ContactSlip>{{2.0, 0.1 * Vec3::UnitX()}, {3.0, -0.2 * Vec3::UnitY()}},
                 0.1);
  EXPECT_LT((friction.impulse() - Vec3(-2.0, 3.0, 0.0)).norm(), 1e-15);
}

TEST(StickSlip, sticksWhileTheTangentialImpulseIsHeld) {
  const Vec3 direction(0.6, 0.0, -0.8);
  const double hold = 2.0;
  for (const double share : {0.5, 0.999, 1.001, 3.0}) {
    StickSlip friction({1, 0, 0}, {}, h);
    friction.begin_pass(hold);
    friction.judge_stick(share * hold * direction, 1e-9);
    EXPECT_EQ(friction.sticks(), share < 1.0);
    EXPECT_EQ(friction.turned(), share > 1.0);
    // What no longer holds it slows it, with all that friction can do.
    const Vec3 expected = share < 1.0 ? Vec3(Vec3::Zero()) : Vec3(hold * direction);
    EXPECT_LT((friction.impulse() - expected).norm(), 1e-15);
    EXPECT_NEAR(friction.change(), std::max(0.0, share - 1.0) * hold, 1e-14);
  }
  StickSlip friction({1, 0, 0}, {}, h);
  friction.begin_pass(0.0);
  friction.judge_stick(1e-9 * direction, 1e-8);  // rounding moves nobody
  EXPECT_TRUE(friction.sticks());
}

TEST(StickSlip, slidingTakesAllThatFrictionCanDo) {
  Slider slider;
  slider.hold = 0.4 * slider.free_slip.norm() / slider.compliance;
  slider.begin();
  for (int k = 0; k < 3; ++k) slider.pass();
  EXPECT_LT((slider.friction.impulse() + slider.hold * slider.free_slip.normalized()).norm(),
            1e-15);
  EXPECT_FALSE(slider.friction.settle());
  EXPECT_FALSE(slider.friction.sticks());
}

TEST(StickSlip, neverMoreThanStopsIt) {
  for (const double excess : {1.2, 3.0, 50.0}) {
    Slider slider;
    slider.hold = excess * slider.free_slip.norm() / slider.compliance;
    slider.begin();  // all of it: drives the node backwards
    EXPECT_GT(slider.slips()[0].slip.dot(slider.friction.impulse()), 0.0);
    for (int k = 0; k < 2; ++k) slider.pass();
    EXPECT_LT(slider.slips()[0].slip.norm(), 1e-12 * slider.free_slip.norm()) << excess;
    slider.pass();
    EXPECT_LT(slider.friction.change(), 1e-12 * slider.hold);
    EXPECT_TRUE(slider.friction.settle());
    EXPECT_TRUE(slider.friction.sticks());
  }
}

TEST(StickSlip, cyclesEnd) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  for (int trial = 0; trial < 200; ++trial) {
    const bool sticks = trial % 2 == 0;
    StickSlip friction({sticks, 0, 0}, {1.0, {}, trial % 3 ? 0.0 : 1.0}, h);
    Vec3 last = Vec3::Zero();
    int turns = 0, changes = 0;
    for (int pass = 1; pass <= 20; ++pass) {
      friction.begin_pass(std::abs(normal(random)));
      // Slips that no friction explains.
      if (friction.sticks())
        friction.judge_stick(10.0 * vector(), 0.0);
      else
        friction.judge_slide(std::vector<ContactSlip>{{friction.hold(), vector()}}, 0);
      turns += friction.turned();
      changes += friction.impulse() != last;
      EXPECT_EQ(pass > 3 && (friction.change() != 0.0 || friction.turned()), false);
      last = friction.impulse();
    }
    EXPECT_LE(changes, 3);
    EXPECT_LE(turns, sticks ? 1 : 0);
  }
}

TEST(StickSlip, waitsLongerEachTimeItBreaksLoose) {
  Slider slider;
  const auto pull = [&](double share) {
    slider.free_slip = share * slider.hold * slider.compliance * Vec3::UnitX();
  };
  slider.friction = StickSlip({1, 0, 0}, {}, h);
  for (const int wait : {1, 3, 7, 15, 15}) {
    pull(1.5);
    slider.step();
    ASSERT_FALSE(slider.friction.sticks());
    ASSERT_EQ(slider.friction.stick().wait, wait);
    // Steps in which friction does not stop it do not count.
    slider.step();
    ASSERT_EQ(slider.friction.stick().wait, wait);
    pull(0.5);
    for (int k = 1; k <= wait; ++k) {
      slider.step();
      ASSERT_FALSE(slider.friction.sticks());
      ASSERT_EQ(slider.friction.stick().wait, wait - k);
    }
    slider.step();
    ASSERT_TRUE(slider.friction.sticks());
  }
  // One step held, and the waits begin from the start.
  slider.step();
  ASSERT_TRUE(slider.friction.sticks());
  pull(1.5);
  slider.step();
  EXPECT_EQ(slider.friction.stick().wait, 1);
}

TEST(StickSlip, doesNotStickAtFirstTouchWhileItWaits) {
  StickSlip friction({0, 1, 1}, {}, h);
  friction.begin(std::vector<ContactSlip>{{1.0, Vec3::Zero()}}, 0.1);
  EXPECT_FALSE(friction.sticks());
}

TEST(StickSlip, rememberedAsForcesForAnyStep) {
  Slider slider;
  slider.begin();
  for (int k = 0; k < 2; ++k) slider.pass();
  const ContactForce force = slider.friction.force(0.03, h);
  EXPECT_DOUBLE_EQ(force.normal, 0.03 / h);
  EXPECT_NEAR(force.inverse_mass, slider.compliance / h, 1e-9 * slider.compliance / h);
  const StickSlip again(slider.friction.stick(), force, 2 * h);
  EXPECT_LT((again.impulse() - 2 * slider.friction.impulse()).norm(), 1e-15);
  EXPECT_EQ(slider.friction.force(-0.03, h).normal, 0.0);  // a pull is none
}

TEST(StickSlip, turnsWithItsPlanes) {
  Slider slider;
  slider.begin();
  const Vec3 before = slider.friction.impulse(), n = Vec3(1, 2, 2) / 3.0;
  slider.friction.turn_to(std::vector<Vec3>{n});
  EXPECT_LT((slider.friction.impulse() - (before - before.dot(n) * n)).norm(), 1e-15);
}

}  // namespace
}  // namespace taut
