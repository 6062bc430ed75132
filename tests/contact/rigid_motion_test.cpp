// Rigid motions of zones: what they keep, and what they refuse.

#include "taut/contact/rigid_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "taut/contact/rigid_zones.h"

namespace taut {
namespace {

struct Cloud {
  std::vector<Vec3> x0, x1;
  std::vector<double> mass;
};

Vec3 random_vector(std::mt19937& generator) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  return {u(generator), u(generator), u(generator)};
}

Cloud random_cloud(unsigned seed, int nodes, double motion) {
  std::mt19937 generator(seed);
  Cloud cloud;
  const Vec3 far(3, -2, 1);
  for (int i = 0; i < nodes; ++i) {
    cloud.x0.push_back(far + 0.01 * random_vector(generator));
    cloud.x1.push_back(cloud.x0.back() + motion * random_vector(generator) + Vec3(0.02, 0, 0.01));
    cloud.mass.push_back(1e-5 * (1.5 + random_vector(generator).x()));
  }
  return cloud;
}

Vec3 linear(const Cloud& c, const std::vector<Vec3>& end) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < end.size(); ++i) sum += c.mass[i] * (end[i] - c.x0[i]);
  return sum;
}

Vec3 angular(const Cloud& c, const std::vector<Vec3>& end, const Vec3& about) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < end.size(); ++i)
    sum += c.mass[i] * (c.x0[i] - about).cross(end[i] - c.x0[i]);
  return sum;
}

std::vector<Vec3> moved(const Cloud& c, const RigidMotion& motion) {
  std::vector<Vec3> end;
  for (const Vec3& x : c.x0) end.push_back(motion(x));
  return end;
}

TEST(RigidMotion, KeepsLinearAndAngularMomentumToRounding) {
  double largest_turn = 0.0;
  for (unsigned seed = 1; seed <= 50; ++seed)
    for (const double size : {1e-6, 1e-3, 5e-3}) {
      const Cloud c = random_cloud(seed, 3 + seed % 20, size);
      const RigidMotion motion = momentum_keeping_motion(c.x0, c.x1, c.mass);
      if (!motion.exact) continue;
      largest_turn = std::max(largest_turn, motion.angle());
      const std::vector<Vec3> end = moved(c, motion);
      const double scale = linear(c, c.x1).norm();
      EXPECT_LE((linear(c, end) - linear(c, c.x1)).norm(), 1e-13 * scale);
      EXPECT_LE((angular(c, end, c.x0[0]) - angular(c, c.x1, c.x0[0])).norm(),
                1e-13 * scale * 0.02 + 1e-12 * angular(c, c.x1, motion.from).norm());
      for (std::size_t i = 1; i < end.size(); ++i)
        EXPECT_NEAR((end[i] - end[0]).norm(), (c.x0[i] - c.x0[0]).norm(), 1e-15) << "not rigid";
    }
  EXPECT_GT(largest_turn, 0.3) << "no cloud that turned";
}

TEST(RigidMotion, FindsTheTurnOfARigidCloud) {
  Cloud c = random_cloud(7, 12, 0.0);
  const Mat3 turn = Eigen::AngleAxisd(0.4, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (std::size_t i = 0; i < c.x0.size(); ++i) c.x1[i] = turn * c.x0[i] + Vec3(0.1, 0.2, 0.3);
  const RigidMotion kept = momentum_keeping_motion(c.x0, c.x1, c.mass);
  ASSERT_TRUE(kept.exact);
  EXPECT_NEAR(kept.angle(), 0.4, 1e-12);
  const auto through = motion_through(c.x0, c.x1, 1e-10);
  ASSERT_TRUE(through);
  for (std::size_t i = 0; i < c.x0.size(); ++i) {
    EXPECT_LE((kept(c.x0[i]) - c.x1[i]).norm(), 1e-13);
    EXPECT_LE(((*through)(c.x0[i]) - c.x1[i]).norm(), 1e-13);
  }
}

TEST(RigidMotion, ThatTurnsTooFarIsCutAndSaysSo) {
  Cloud c = random_cloud(3, 8, 0.0);
  const Vec3 middle = momentum_keeping_motion(c.x0, c.x0, c.mass).from;
  for (std::size_t i = 0; i < c.x0.size(); ++i)
    c.x1[i] = c.x0[i] + Vec3(0, 0, 5).cross(c.x0[i] - middle);
  const RigidMotion motion = momentum_keeping_motion(c.x0, c.x1, c.mass);
  EXPECT_FALSE(motion.exact);
  EXPECT_NEAR(motion.angle(), 1.0, 1e-9);
}

TEST(RigidMotion, OfNodesOnALineIsTheLeast) {
  const std::vector<Vec3> x0{{0, 0, 0}, {0.01, 0, 0}, {0.03, 0, 0}};
  std::vector<Vec3> x1 = x0;
  x1[0].y() += 1e-3, x1[2].y() -= 1e-3;
  const std::vector<double> mass{1e-5, 2e-5, 1e-5};
  const RigidMotion motion = momentum_keeping_motion(x0, x1, mass);
  ASSERT_TRUE(motion.exact);
  EXPECT_NEAR(motion.rotation(2, 2), 1.0, 1e-12) << "turns about z only";
  EXPECT_LT(motion(x0[2]).y(), motion(x0[0]).y());
}

TEST(MotionThrough, OnePointIsATranslationAndContradictionsAreRefused) {
  const std::vector<Vec3> one{{1, 2, 3}}, moved_one{{1, 2, 4}};
  const auto motion = motion_through(one, moved_one, 1e-9);
  ASSERT_TRUE(motion);
  EXPECT_EQ((*motion)(Vec3(5, 5, 5)), Vec3(5, 5, 6));
  const std::vector<Vec3> two{{0, 0, 0}, {0.1, 0, 0}}, pressed{{0.01, 0, 0}, {0.09, 0, 0}};
  EXPECT_FALSE(motion_through(two, pressed, 1e-3));
  EXPECT_TRUE(motion_through(two, pressed, 0.02));
}

TEST(RigidZones, MergeWhenTheyShareAPairAndHoldersJoinNone) {
  const std::vector<double> mass(10, 1e-5);
  std::vector<std::uint8_t> held(10, 0);
  held[4] = 1;
  std::vector<Vec3> x0, x1;
  std::mt19937 generator(5);
  for (int i = 0; i < 10; ++i) x0.push_back(0.01 * random_vector(generator));
  for (int i = 0; i < 10; ++i) x1.push_back(x0[i] + 0.001 * random_vector(generator));
  RigidZones zones(mass, held);
  const std::vector<Index> first{0, 1, 2, 4}, second{5, 6, 7, 4}, bridge{2, 5, 8, 9},
      held_only{4, 4, 4, 4};
  EXPECT_TRUE(zones.join(first, x0, x1));
  EXPECT_FALSE(zones.join(first, x0, x1));
  EXPECT_TRUE(zones.join(second, x0, x1));
  EXPECT_EQ(zones.zones().size(), 2u) << "a holder joins no zones";
  EXPECT_FALSE(zones.together(first));
  EXPECT_TRUE(zones.join(bridge, x0, x1));
  EXPECT_EQ(zones.zones().size(), 1u);
  EXPECT_EQ(zones.node_count(), 9 - 1);  // 0 1 2 5 6 7 8 9
  EXPECT_FALSE(zones.join(held_only, x0, x1));
  std::vector<std::uint8_t> moved(10, 0);
  const std::vector<Vec3> before = x1;
  EXPECT_EQ(zones.move(x0, x1, 1e-9, moved), nullptr);
  EXPECT_EQ(x1[4], before[4]);
  EXPECT_EQ(x1[3], before[3]);
  EXPECT_LE((x1[0] - x0[0] - (x1[9] - x0[9])).norm(), 1e-16)
      << "carried by one holder: a translation";
  EXPECT_LE((x1[0] - x0[0] - (x1[4] - x0[4])).norm(), 1e-16);
}

TEST(RigidZones, SayThatTheyArePinched) {
  const std::vector<double> mass(3, 1e-5);
  const std::vector<std::uint8_t> held{1, 1, 0};
  const std::vector<Vec3> x0{{0, 0, 1e-3}, {0, 0, -1e-3}, {0, 0, 0}};
  std::vector<Vec3> x1{{0, 0, -1e-3}, {0, 0, 1e-3}, {0, 0, 0}};
  RigidZones zones(mass, held);
  const std::vector<Index> pair{0, 1, 2};
  EXPECT_TRUE(zones.join(pair, x0, x1));
  std::vector<std::uint8_t> moved(3, 0);
  const RigidZone* pinched = zones.move(x0, x1, 1e-5, moved);
  ASSERT_NE(pinched, nullptr);
  EXPECT_EQ(pinched->nodes, std::vector<Index>{2});
}

}  // namespace
}  // namespace taut
