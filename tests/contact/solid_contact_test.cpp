#include <cmath>
#include <numbers>
#include <random>

#include "contact/point_masses.h"
#include "taut/base/error.h"
#include "taut/base/parallel.h"

namespace taut {
namespace {

using test::PointMasses;
constexpr double g = 9.81, h = 5e-3;

SolidContact contact_with(std::vector<Solid> solids, Index nodes = 1, ContactOptions options = {}) {
  return SolidContact(std::move(solids), nodes, options);
}

class RestingNode : public testing::TestWithParam<std::pair<Solid, Vec3>> {};

TEST_P(RestingNode, staysAndIsPushedByItsWeight) {
  auto [solid, top] = GetParam();
  for (const double friction : {0.0, 0.4}) {
    solid.friction = friction;
    PointMasses masses({top});
    SolidContact contact = contact_with({solid});
    for (int k = 0; k < 200; ++k) {
      masses.step(contact, h);
      ASSERT_LT((masses.x[0] - top).norm(), 1e-12) << "step " << k;
      ASSERT_NEAR(masses.j[0].z(), masses.mass * g * h, 1e-12);
      ASSERT_EQ(masses.constraints.ndof(0), friction > 0.0 ? 0 : 2);
    }
    EXPECT_EQ(masses.most_passes, 1);
    EXPECT_EQ(contact.contacts(), 1);
    EXPECT_EQ(contact.sticking(), friction > 0.0 ? 1 : 0);
  }
}

Solid thick(Solid solid, double thickness) {
  solid.thickness = thickness;
  return solid;
}

INSTANTIATE_TEST_SUITE_P(
    eachSolid, RestingNode,
    testing::Values(std::pair(test::plane(Vec3::UnitZ()), Vec3(0.3, -2.0, 0.0)),
                    std::pair(test::sphere(0.2), Vec3(0.0, 0.0, 0.2)),
                    std::pair(test::box(Vec3(1, 2, 3)), Vec3(0.2, 0.1, 1.5)),
                    std::pair(test::cylinder(0.3, 0.8), Vec3(0.1, 0.1, 0.4)),
                    std::pair(thick(test::sphere(0.2), 0.01), Vec3(0.0, 0.0, 0.21)),
                    std::pair(thick(test::box(Vec3(1, 2, 3)), 0.02), Vec3(0.2, 0.1, 1.52))));

// Incline of angle theta; a block of nodes at rest on it, or sliding down with acceleration g (sin
// - mu cos). The discrete sum of semi-implicit Euler is exact: v_n = n h a, x_n = a h² n (n + 1) /
//   2.
void slide_down(double theta, double mu, std::vector<Vec3> offsets) {
  const Vec3 normal(std::sin(theta), 0.0, std::cos(theta)),
      down(std::cos(theta), 0.0, -std::sin(theta));
  for (Vec3& x : offsets) x = x.x() * down + x.y() * Vec3::UnitY();
  const Index nodes = static_cast<Index>(offsets.size());
  PointMasses masses(offsets);
  SolidContact contact = contact_with({test::plane(normal, mu)}, nodes);
  const int steps = 100;
  masses.run(contact, h, steps);
  const double a = std::max(0.0, g * (std::sin(theta) - mu * std::cos(theta)));
  // Where sticking fails by less than 5 % of friction, the node slides from the next step on.
  const double tolerance = 1e-11 + (a < 0.05 * g ? a * h * h * steps : 0.0);
  for (Index i = 0; i < nodes; ++i) {
    const Vec3 moved = masses.x[i] - offsets[i];
    EXPECT_LT((moved - 0.5 * a * h * h * steps * (steps + 1) * down).norm(), tolerance)
        << "node " << i << ", mu " << mu;
    EXPECT_NEAR(masses.j[i].dot(normal), masses.mass * g * h * std::cos(theta), 1e-14);
  }
  EXPECT_EQ(contact.sticking(), std::tan(theta) <= mu ? nodes : 0);
  EXPECT_LE(masses.most_passes, 3);
}

TEST(Incline, nodeSlidesOrSticksByTheFrictionAngle) {
  const double theta = 0.5;
  for (const double mu :
       {0.0, 0.1, 0.3, std::tan(theta) * (1 - 1e-6), std::tan(theta) * (1 + 1e-6), 2.0})
    slide_down(theta, mu, {Vec3::Zero()});
}

TEST(Incline, blockOfNodes) {
  std::vector<Vec3> block;
  for (int i = 0; i < 30; ++i)
    for (int k = 0; k < 30; ++k) block.emplace_back(0.02 * i, 0.02 * k, 0.0);
  for (const double mu : {0.2, 0.6}) slide_down(0.45, mu, block);
}

TEST(Incline, nodePushedUpwardsStopsAndStays) {
  const double theta = 0.3, mu = 0.5, speed = 1.0;
  const Vec3 normal(std::sin(theta), 0.0, std::cos(theta)),
      up(-std::cos(theta), 0.0, std::sin(theta));
  PointMasses masses({Vec3::Zero()}, speed * up + 0.0 * normal);
  SolidContact contact = contact_with({test::plane(normal, mu)});
  masses.run(contact, h, 400);
  const double a = g * (std::sin(theta) + mu * std::cos(theta));
  const double path = masses.x[0].dot(up);
  // Euler and the stop within a step: first order
  EXPECT_NEAR(path, speed * speed / (2 * a), speed * h);
  EXPECT_LT(masses.v[0].norm(), 1e-12);
  EXPECT_EQ(contact.sticking(), 1);
  EXPECT_LE(masses.most_passes, 3);
}

TEST(Incline, crosswiseSlideLosesItsCrosswisePart) {
  // Friction opposes the whole velocity, so a node pushed across the slope turns down the slope:
  // dv_y/dt = -mu g cos v_y / |v|.
  const double theta = 0.6, mu = 0.3;
  const Vec3 normal(std::sin(theta), 0.0, std::cos(theta)),
      down(std::cos(theta), 0.0, -std::sin(theta));
  const double small = 1e-4;
  PointMasses masses({Vec3::Zero()}, Vec3(0, 1, 0));
  SolidContact contact = contact_with({test::plane(normal, mu)});
  masses.run(contact, small, 5000);
  Vec2 velocity(0.0, 1.0);  // the same by an ODE solver: midpoint rule with a tenth of the step
  const double fine = 1e-5;
  const auto acceleration = [&](const Vec2& u) {
    return Vec2(Vec2(g * std::sin(theta), 0.0) - mu * g * std::cos(theta) * u.normalized());
  };
  for (int k = 0; k < 50000; ++k)
    velocity += fine * acceleration(velocity + 0.5 * fine * acceleration(velocity));
  EXPECT_NEAR(masses.v[0].dot(down), velocity.x(), 2e-3);
  EXPECT_NEAR(masses.v[0].y(), velocity.y(), 2e-3);
}

TEST(MovingFloor, frictionCarriesAndNoFrictionDoesNot) {
  for (const double mu : {0.0, 0.5}) {
    Solid floor = test::plane(Vec3::UnitZ(), mu);
    floor.velocity = Vec3(0.4, -0.2, 0.1);
    PointMasses masses({Vec3(0.1, 0.2, 0.0)}, Vec3(0, 0, 0.1));
    SolidContact contact = contact_with({floor});
    const int steps = 300;
    masses.run(contact, h, steps);
    const double T = steps * h;
    EXPECT_NEAR(masses.x[0].z(), 0.1 * T, 1e-12);
    if (mu == 0.0) {
      EXPECT_LT((masses.x[0] - Vec3(0.1, 0.2, 0.1 * T)).norm(), 1e-12);
      continue;
    }
    // It slips until Coulomb's friction has given it the floor's speed u: it lags behind by u² / (2
    // mu g), Euler's first order aside.
    const double u = std::hypot(0.4, 0.2);
    const Vec3 behind = Vec3(0.1, 0.2, 0.0) + T * floor.velocity - masses.x[0];
    EXPECT_NEAR(behind.norm(), u * u / (2 * mu * g), u * h);
    EXPECT_LT((masses.v[0] - floor.velocity).norm(), 1e-12);
    EXPECT_EQ(contact.sticking(), 1);
  }
}

TEST(MovingFloor, pullingAwayLetsGo) {
  Solid floor = test::plane(Vec3::UnitZ(), 0.5);
  floor.velocity = Vec3(0, 0, -1.0);
  floor.key_frames = {{0.0, {}}, {0.1, {}}, {0.2, {}}};
  floor.key_frames[2].pose.translation = Vec3(0, 0, -1.0);  // 10 m/s down: faster than falling
  PointMasses masses({Vec3::Zero()});
  SolidContact contact = contact_with({floor});
  masses.run(contact, h, 20);
  EXPECT_EQ(contact.contacts(), 1);
  EXPECT_NEAR(masses.x[0].z(), 0.0, 1e-14);
  masses.run(contact, h, 10);
  EXPECT_EQ(contact.contacts(), 0);
  // free fall from the first such step on
  EXPECT_NEAR(masses.x[0].z(), -0.5 * g * h * h * 10 * 11, 1e-12);
}

TEST(MovingFloor, touchingWithoutForceStays) {
  PointMasses masses({Vec3::Zero()});
  masses.gravity.setZero();
  SolidContact contact = contact_with({test::plane(Vec3::UnitZ(), 0.3)});
  masses.run(contact, h, 5);
  EXPECT_EQ(contact.contacts(), 1);
  EXPECT_EQ(masses.most_passes, 1);
}

// A floor that is given a new velocity between steps does as one whose key frames say so.
TEST(MovingFloor, motionSetBetweenStepsDoesAsKeyFrames) {
  const Vec3 velocities[3] = {Vec3(0.3, 0.0, 0.1), Vec3(-0.5, 0.2, 0.2), Vec3(0.0, 0.0, -0.05)};
  const int steps = 80;
  Solid keyed = test::plane(Vec3::UnitZ(), 0.4);
  keyed.key_frames = {{0.0, keyed.initial}};
  for (const Vec3& velocity : velocities) {
    KeyFrame next = keyed.key_frames.back();
    next.time += steps * h;
    next.pose.translation += steps * h * velocity;
    keyed.key_frames.push_back(next);
  }
  PointMasses one({Vec3(0.1, 0.2, 0.0)}), other = one;
  SolidContact by_frames = contact_with({keyed}),
               by_hand = contact_with({test::plane(Vec3::UnitZ(), 0.4)});
  for (int k = 0; k < 3; ++k) {
    Solid floor = test::plane(Vec3::UnitZ());
    floor.velocity = velocities[k];
    floor.initial.translation =
        keyed.key_frames[k].pose.translation - keyed.key_frames[k].time * velocities[k];
    by_hand.set_solid(0, floor);
    one.run(by_frames, h, steps);
    other.run(by_hand, h, steps);
    ASSERT_LT((one.x[0] - other.x[0]).norm(), 1e-12);
    ASSERT_LT((one.v[0] - other.v[0]).norm(), 1e-12);
    // Friction of the floor that was there at first has made the node as fast as the floor.
    ASSERT_LT((other.v[0] - velocities[k]).norm(), 1e-10);
  }
}

TEST(RotatingSphere, frictionCarriesNodeRoundItsCircle) {
  const double R = 0.2, omega = 2.0;
  Solid ball = test::sphere(R, 10.0, Vec3(0.3, -0.1, 0.5));
  ball.angular_velocity = Vec3(0, 0, omega);
  const double latitude = 1.0;
  const Vec3 arm = R * Vec3(std::cos(latitude), 0.0, std::sin(latitude));
  PointMasses masses({ball.initial.translation + arm}, Vec3(0, omega * arm.x(), 0));
  SolidContact contact = contact_with({ball});
  const int steps = 1000;
  const double turn = 2 * std::numbers::pi / omega / steps;
  for (int k = 1; k <= steps; ++k) {
    masses.step(contact, turn);
    const Vec3 expected =
        ball.initial.translation + Eigen::AngleAxisd(omega * k * turn, Vec3::UnitZ()) * arm;
    ASSERT_LT((masses.x[0] - expected).norm(), 1e-10) << "step " << k;
    ASSERT_LE(contact.passes(), k == 1 ? 2 : 1);
  }
}

TEST(RotatingSphere, oppositeTurnAndTranslationTogether) {
  Solid ball = test::sphere(0.2, 10.0);
  ball.velocity = Vec3(0.5, 0.2, 0.0);
  ball.angular_velocity = Vec3(0.1, 0.2, -3.0);
  const Vec3 arm(0.0, 0.0, 0.2);
  PointMasses masses({arm}, ball.velocity + ball.angular_velocity.cross(arm));
  SolidContact contact = contact_with({ball});
  masses.run(contact, 1e-3, 300);
  EXPECT_LT((masses.x[0] - ball.pose(0.3).to_world(arm)).norm(), 1e-10);
}

TEST(ThrownNodes, neverEndInside) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Solid> shapes = {test::sphere(0.2), test::box(Vec3(0.4, 0.3, 0.02)),
                               test::cylinder(0.2, 0.3),
                               thick(test::box(Vec3(0.4, 0.3, 0.4)), 0.01)};
  for (Solid& solid : shapes)
    for (const double mu : {0.0, 0.3})
      for (const bool turning : {false, true}) {
        solid.friction = mu;
        solid.angular_velocity = turning ? Vec3(1, 2, -3) : Vec3::Zero();
        std::vector<Vec3> starts;
        PointMasses masses({});
        for (int k = 0; k < 400; ++k) {
          const Vec3 from =
              0.6 * Vec3(uniform(random), uniform(random), uniform(random)).normalized();
          const Vec3 aim = 0.2 * Vec3(uniform(random), uniform(random), uniform(random));
          masses.x.push_back(from);
          masses.v.push_back(4.0 * (aim - from).normalized());
        }
        masses.pins.reset(masses.nodes());
        SolidContact contact = contact_with({solid}, masses.nodes());
        int touches = 0;
        for (int k = 0; k < 100; ++k) {
          const std::vector<Vec3> before = masses.x;
          masses.step(contact, 6.67e-3);
          touches += contact.contacts();
          for (Index i = 0; i < masses.nodes(); ++i) {
            // The tolerance stated in solid_contact.h: 2e-4 of the size.
            ASSERT_GT(test::gap_of(solid, masses.t, masses.x[i]), -2.5e-4 * 0.2)
                << "node " << i << ", step " << k;
            // Nor does it jump through the plate's middle.
            if (solid.size.z() > 0.05) continue;
            const Vec3 q0 = solid.pose(masses.t - 6.67e-3).to_local(before[i]),
                       q1 = solid.pose(masses.t).to_local(masses.x[i]);
            const auto over_middle = [](const Vec3& q) {
              return std::abs(q.x()) < 0.17 && std::abs(q.y()) < 0.12;
            };
            ASSERT_FALSE(over_middle(q0) && over_middle(q1) && q0.z() * q1.z() < 0.0)
                << "node " << i << ", step " << k;
          }
        }
        EXPECT_GT(touches, 500);
        EXPECT_EQ(contact.counts().moved, 0);
      }
}

TEST(ThrownNode, stopsAndStaysWithGreatFriction) {
  PointMasses masses({Vec3(0, 0, 0.1)}, Vec3(3, 0, -3));
  masses.gravity.setZero();
  SolidContact contact = contact_with({test::plane(Vec3::UnitZ(), 1e6)});
  masses.run(contact, 0.03, 20);
  // where its path met the floor, whatever the step
  EXPECT_LT((masses.x[0] - Vec3(0.1, 0, 0)).norm(), 1e-9);
}

TEST(ThrownNode, coulombTakesMuTimesTheNormalImpulse) {
  const double mu = 0.25;
  PointMasses masses({Vec3(0, 0, 0.1)}, Vec3(3, 1, -2));
  masses.gravity.setZero();
  SolidContact contact = contact_with({test::plane(Vec3::UnitZ(), mu)});
  masses.run(contact, 0.03, 20);
  const double speed = std::hypot(3.0, 1.0) - mu * 2.0;
  EXPECT_NEAR(masses.v[0].z(), 0.0, 1e-14);
  EXPECT_NEAR(masses.v[0].norm(), speed, 1e-12);
  EXPECT_NEAR(masses.v[0].y() / masses.v[0].x(), 1.0 / 3.0, 1e-12);
}

// Two planes whose normals are 60 degrees apart make a valley along `valley`, tilted so that the
// node runs down it. The impulses follow from statics: both normals share the load; friction along
// the valley is mu (lambda1 + lambda2).
TEST(Valley, slidesAlongItByTheClosedForm) {
  const double tilt = 0.5;
  const Eigen::AngleAxisd turn(tilt, Vec3::UnitY());
  const Vec3 valley = turn * Vec3::UnitX();
  const Vec3 n1 = turn * Vec3(0, 0.5, std::sqrt(0.75)), n2 = turn * Vec3(0, -0.5, std::sqrt(0.75));
  for (const double mu : {0.0, 0.2, 2.0}) {
    PointMasses masses({Vec3::Zero()});
    SolidContact contact = contact_with({test::plane(n1, mu), test::plane(n2, mu)});
    const int steps = 100;
    masses.run(contact, h, steps);
    const double lambda = g * std::cos(tilt) / (2 * std::sqrt(0.75));  // of each, per mass
    const double a = std::max(0.0, g * std::sin(tilt) - 2 * mu * lambda);
    EXPECT_EQ(masses.constraints.ndof(0), a > 0.0 ? 1 : 0);
    EXPECT_LT((masses.x[0] - 0.5 * a * h * h * steps * (steps + 1) * valley).norm(), 1e-11)
        << "mu " << mu;
    EXPECT_EQ(contact.contacts(), 2);
  }
}

TEST(Valley, oneSideLetsGoWhenItWouldPull) {
  const Vec3 n1 = Vec3(0, std::sin(0.5), std::cos(0.5)),
             n2 = Vec3(0, -std::sin(0.5), std::cos(0.5));
  PointMasses masses({Vec3::Zero()});
  masses.gravity = Vec3(0, 8.0, -5.0);  // up along plane 2, away from plane 1: only plane 2 pushes
  SolidContact contact = contact_with({test::plane(n1), test::plane(n2)});
  masses.run(contact, h, 20);
  EXPECT_EQ(contact.contacts(), 1);
  EXPECT_NEAR(n2.dot(masses.x[0]), 0.0, 1e-12);
  EXPECT_GT(n1.dot(masses.x[0]), 1e-3);
  const Vec3 along(0, std::cos(0.5), std::sin(0.5));
  EXPECT_NEAR(along.dot(masses.x[0]), 0.5 * along.dot(masses.gravity) * h * h * 20 * 21, 1e-12);
}

TEST(Corner, ofThreePlanesLeavesNoFreedom) {
  const Vec3 n[3] = {Vec3(1, 0.2, 1).normalized(), Vec3(-1, 1, 1).normalized(),
                     Vec3(-0.3, -1, 1).normalized()};
  PointMasses masses({Vec3(0, 0, 0.3)}, Vec3(0.1, 0.2, 0.0));
  SolidContact contact = contact_with({test::plane(n[0]), test::plane(n[1]), test::plane(n[2])});
  masses.run(contact, h, 1000);
  EXPECT_EQ(masses.constraints.ndof(0), 0);
  EXPECT_LT(masses.x[0].norm(), 1e-9);
  EXPECT_LT((masses.j[0] + h * masses.mass * masses.gravity).norm(), 1e-12);
}

TEST(Pins, pinnedNodeIsNeverAContactAndPartlyPinnedOneObeysBoth) {
  PointMasses masses({Vec3(0, 0, 0), Vec3(1, 0, 0)});
  masses.pins.fix(0, Vec3::Zero());
  masses.pins.constrain(1, Vec3::UnitX(), 0.0);
  const Vec3 normal = Vec3(1, 1, 2).normalized();
  SolidContact contact = contact_with(
      {test::plane(normal, 0.0, Vec3(0, 0, 0)), test::plane(normal, 0.0, Vec3(1, 0, 0))}, 2);
  masses.run(contact, h, 50);
  EXPECT_EQ(masses.x[0], Vec3(0, 0, 0));
  EXPECT_EQ(contact.contacts(), 1);
  EXPECT_EQ(masses.constraints.ndof(1), 1);
  // Node 1 slides on the line x = 1 of the second plane: direction (0, 2, -1).
  const Vec3 line = Vec3(0, 2, -1).normalized();
  EXPECT_LT((masses.x[1] - Vec3(1, 0, 0) - 0.5 * line.z() * -g * h * h * 50 * 51 * line).norm(),
            1e-12);
}

TEST(BoxOnFloor, nodeInTheAngleIsPushedAlong) {
  // A box moves along the floor and pushes a node before it; each solid is its own contact.
  Solid pusher = test::box(Vec3(0.2, 0.2, 0.2));
  // its lower face is under the floor, so that the node meets its side
  pusher.initial.translation = Vec3(-0.1, 0, 0.05);
  pusher.velocity = Vec3(0.5, 0, 0);
  for (const double mu : {0.0, 0.3}) {
    pusher.friction = 0.0;
    PointMasses masses({Vec3(0.01, 0.0, 0.0)});
    SolidContact contact = contact_with({test::plane(Vec3::UnitZ(), mu), pusher});
    masses.run(contact, h, 100);
    EXPECT_EQ(contact.contacts(), 2);
    EXPECT_LT((masses.x[0] - Vec3(0.25, 0, 0)).norm(), 1e-9) << "mu " << mu;
    EXPECT_NEAR(masses.j[0].z(), masses.mass * g * h, 1e-12);
  }
}

PointMasses rain(Index nodes) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  std::vector<Vec3> start;
  for (Index i = 0; i < nodes; ++i)
    start.emplace_back(uniform(random), uniform(random), 0.35 + 0.3 * uniform(random));
  return PointMasses(start, Vec3(0.2, 0.1, -1.0));
}

std::vector<Solid> scene() {
  Solid ball = test::sphere(0.2, 0.3);
  ball.angular_velocity = Vec3(0, 1, 2);
  return {test::plane(Vec3::UnitZ(), 0.2), ball};
}

TEST(State, restoredRunGoesOnToTheSameBits) {
  PointMasses masses = rain(500);
  SolidContact contact = contact_with(scene(), 500);
  masses.run(contact, h, 60);
  PointMasses again = masses;
  const ContactState saved = contact.state();
  EXPECT_GT(saved.node.size(), 100u);
  masses.run(contact, h, 40);
  SolidContact fresh = contact_with(scene(), 500);
  fresh.restore(saved);
  again.run(fresh, h, 40);
  EXPECT_EQ(masses.x, again.x);
  EXPECT_EQ(masses.v, again.v);
  EXPECT_EQ(contact.state(), fresh.state());
}

TEST(State, badOneIsRefused) {
  SolidContact contact = contact_with(scene(), 500);
  const ContactStick stick{1, 0, 0};
  const ContactForce force{1.0, {}, 0.0};
  EXPECT_THROW(contact.restore({{1}, {0}, {stick}, {}}), InputError);
  EXPECT_THROW(contact.restore({{500}, {0}, {stick}, {force}}), InputError);
  EXPECT_THROW(contact.restore({{1}, {2}, {stick}, {force}}), InputError);
  EXPECT_THROW(contact.restore({{2, 1}, {0, 0}, {stick, stick}, {force, force}}), InputError);
}

TEST(Threads, sameBitsForAnyNumber) {
  const int before = thread_count();
  std::vector<std::vector<Vec3>> ends;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    PointMasses masses = rain(20000);
    SolidContact contact = contact_with(scene(), 20000);
    masses.run(contact, h, 30);
    ends.push_back(masses.x);
  }
  set_thread_count(before);
  EXPECT_EQ(ends[0], ends[1]);
  EXPECT_EQ(ends[0], ends[2]);
}

}  // namespace
}  // namespace taut
