// The spring laws: energy, force and the two Jacobians against each other by finite differences, on
// both sides of every branch.

#include "taut/element/spring_law.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <random>

#include "element/finite_difference.h"

namespace taut {
namespace {

struct Case {
  const char* name;
  SpringLawKind law;
  SpringParameters p;
  std::vector<double> branches;  // lengths at which the law changes, m
};

std::vector<Case> cases() {
  const SpringParameters stiff{.rest_length = 0.02, .stiffness = 600.0, .damping = 0.7};
  // A fabric of 1e-5 N m over strips of 2 cm; its line would push 480 times stronger than the beam.
  SpringParameters beam{.rest_length = 0.02, .stiffness = 1e-5, .damping = 0.01, .cap = 600.0};
  beam.beam = beam_range(beam);
  // A line so soft that the beam never pushes less; and one so soft that it does only in the middle
  // (c_b L0³/k_b between 31.4 and 4π²).
  const SpringParameters soft{
      .rest_length = 0.02, .stiffness = 1e-5, .damping = 0.01, .cap = 20.0 * 1e-5 / 8e-6};
  const SpringParameters middle{
      .rest_length = 0.02, .stiffness = 1e-5, .damping = 0.01, .cap = 35.0 * 1e-5 / 8e-6};
  const double l0 = 0.02;
  std::vector<Case> all{{"linear", SpringLawKind::linear, stiff, {0.0, l0}},
                        {"buckling", SpringLawKind::buckling, stiff, {0.0, l0}},
                        {"choi_ko", SpringLawKind::choi_ko, beam, {0.0, beam.beam.upper, l0}},
                        {"choi_ko, soft line", SpringLawKind::choi_ko, soft, {0.0, l0}},
                        {"choi_ko, line soft in the middle",
                         SpringLawKind::choi_ko,
                         middle,
                         {0.0, beam_range(middle).lower, beam_range(middle).upper, l0}}};
  return all;
}

// Lengths on both sides of every branch, near it and far from it, and how far (m) the nearest
// branch is.
std::vector<std::pair<double, double>> lengths(const Case& c) {
  const double l0 = c.p.rest_length;
  std::vector<double> all{0.05 * l0, 0.1 * l0,  0.33 * l0, 0.5 * l0, 0.8 * l0,
                          0.95 * l0, 1.05 * l0, 1.3 * l0,  3.0 * l0};
  for (const double branch : c.branches)
    for (const double away : {1e-3, 1e-2}) {
      all.push_back(branch + away * l0);
      if (branch > 0.0) all.push_back(branch - away * l0);
    }
  std::vector<std::pair<double, double>> with_room;
  for (const double length : all) {
    double room = length;
    for (const double branch : c.branches) room = std::min(room, std::abs(length - branch));
    with_room.emplace_back(length, room);
  }
  return with_room;
}

const Vec3 direction = Vec3(0.48, -0.6, 0.64);
const Vec3 velocity = Vec3(0.3, 0.9, -0.4);  // of j relative to i

// N/m that errors are measured against: how strongly the spring resists at this length.
double stiffness_scale(const SpringResponse& r, const SpringParameters& p, double length) {
  return r.exact_stiffness().norm() + r.force.norm() / length +
         p.damping * velocity.norm() / length + 1e-300;
}

TEST(SpringLaw, ForceIsMinusTheGradientOfTheEnergy) {
  for (const Case& c : cases())
    for (const auto& [length, room] : lengths(c)) {
      const Vec3 d = length * direction;
      const Vec3 force = spring_response(c.law, c.p, d, Vec3::Zero()).force;
      // On i, and d = x_j - x_i: -∂E/∂x_i = ∂E/∂d.
      const auto gradient = [&](double step) {
        return test::numeric_gradient(
            [&](const Vec3& a) { return spring_response(c.law, c.p, a, Vec3::Zero()).energy; }, d,
            step);
      };
      const double scale =
          force.norm() +
          1e-4 * c.p.rest_length * spring_tension(c.law, c.p, 1.5 * c.p.rest_length).slope;
      EXPECT_LT(test::least_error(gradient, force, 0.1 * room), 1e-7 * scale)
          << c.name << ", L/L0 = " << length / c.p.rest_length;
    }
}

TEST(SpringLaw, ExactStiffnessIsMinusTheGradientOfTheForce) {
  for (const Case& c : cases())
    for (const auto& [length, room] : lengths(c))
      for (const Vec3& v : {Vec3(Vec3::Zero()), velocity, Vec3(-velocity)}) {
        const Vec3 d = length * direction;
        const SpringResponse r = spring_response(c.law, c.p, d, v);
        // The whole force, damping too; -∂f_i/∂x_i = ∂f_i/∂d.
        const auto jacobian = [&](double step) {
          return test::numeric_jacobian(
              [&](const Vec3& a) { return spring_response(c.law, c.p, a, v).force; }, d, step);
        };
        const double scale = stiffness_scale(r, c.p, length);
        EXPECT_LT(test::least_error(jacobian, r.exact_stiffness(), 0.1 * room), 1e-7 * scale)
            << c.name << ", L/L0 = " << length / c.p.rest_length;
      }
}

TEST(SpringLaw, DampingIsMinusTheVelocityGradientOfTheForce) {
  for (const Case& c : cases())
    for (const auto& [length, room] : lengths(c)) {
      const Vec3 d = length * direction;
      const SpringResponse r = spring_response(c.law, c.p, d, velocity);
      const auto jacobian = [&](double step) {
        return test::numeric_jacobian(
            [&](const Vec3& w) { return spring_response(c.law, c.p, d, w).force; }, velocity, step);
      };
      EXPECT_LT(test::least_error(jacobian, r.damping, 0.1), 1e-9 * (c.p.damping + r.force.norm()))
          << c.name;
      EXPECT_EQ(r.damping.norm() > 0.0, r.force.norm() > 0.0)
          << c.name << ": a spring damps exactly when it is not slack";
    }
}

// What is dropped is what docs/mathematics.md names: only the transverse term, only in compression;
// and the damping force's change with x.
TEST(SpringLaw, DroppedTermsAreTheNamedOnes) {
  for (const Case& c : cases())
    for (const auto& [length, room] : lengths(c)) {
      const Vec3 d = length * direction;
      const SpringResponse r = spring_response(c.law, c.p, d, velocity);
      const Mat3 across = Mat3::Identity() - direction * direction.transpose();
      const double tension = spring_tension(c.law, c.p, length).tension;
      const double expected = tension < 0.0 ? tension / length : 0.0;
      EXPECT_LT((r.dropped_transverse - expected * across).norm(),
                1e-12 * stiffness_scale(r, c.p, length))
          << c.name;
      if (length > c.p.rest_length) {
        EXPECT_EQ(r.dropped_transverse.norm(), 0.0) << c.name;
        const double k = c.law == SpringLawKind::choi_ko ? c.p.cap : c.p.stiffness;
        const Mat3 full =
            k * (direction * direction.transpose() + (1.0 - c.p.rest_length / length) * across);
        EXPECT_LT((r.stiffness - full).norm(), 1e-12 * full.norm()) << c.name;
      }
      EXPECT_EQ(spring_response(c.law, c.p, d, Vec3::Zero()).dropped_damping.norm(), 0.0);
    }
}

TEST(SpringLaw, UsedMatricesAreSymmetricAndPositiveSemidefinite) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0), exponent(-3.0, 0.5);
  for (const Case& c : cases())
    for (int trial = 0; trial < 4000; ++trial) {
      const Vec3 axis = Vec3(uniform(random), uniform(random), uniform(random)).normalized();
      const Vec3 d = c.p.rest_length * std::pow(10.0, exponent(random)) * axis;
      const SpringResponse r = spring_response(
          c.law, c.p, d, 5.0 * Vec3(uniform(random), uniform(random), uniform(random)));
      for (const Mat3& m : {r.stiffness, r.damping}) {
        EXPECT_LE((m - m.transpose()).norm(), 1e-15 * m.norm());
        EXPECT_GE(Eigen::SelfAdjointEigenSolver<Mat3>(m).eigenvalues()[0], -1e-14 * m.norm())
            << c.name << ", d = " << d.transpose();
      }
    }
}

TEST(SpringLaw, CollapsedSpringGivesNothing) {
  for (const Case& c : cases()) {
    const SpringResponse r = spring_response(c.law, c.p, Vec3::Zero(), velocity);
    EXPECT_EQ(r.force, Vec3(Vec3::Zero())) << c.name;
    EXPECT_EQ(r.stiffness, Mat3(Mat3::Zero())) << c.name;
    EXPECT_EQ(r.damping, Mat3(Mat3::Zero())) << c.name;
    EXPECT_EQ(r.exact_stiffness(), Mat3(Mat3::Zero())) << c.name;
    EXPECT_EQ(r.energy, 0.0) << c.name;
  }
}

TEST(SpringLaw, SlackSpringNeitherPushesNorDamps) {
  const SpringParameters p{.rest_length = 1.0, .stiffness = 5.0, .damping = 3.0};
  const SpringResponse r =
      spring_response(SpringLawKind::buckling, p, Vec3(0.9, 0, 0), Vec3(1, 2, 3));
  EXPECT_EQ(r.force, Vec3(Vec3::Zero()));
  EXPECT_EQ(r.damping, Mat3(Mat3::Zero()));
  EXPECT_EQ(r.energy, 0.0);
  const SpringResponse pushes =
      spring_response(SpringLawKind::linear, p, Vec3(0.9, 0, 0), Vec3(1, 2, 3));
  EXPECT_NEAR(pushes.force.x(), 5.0 * -0.1 + 3.0 * 1.0, 1e-14);
  EXPECT_EQ(pushes.damping, Mat3(3.0 * Vec3::UnitX() * Vec3::UnitX().transpose()));
}

TEST(SpringLaw, ForceIsContinuousAtTheBranches) {
  for (const Case& c : cases())
    for (const double branch : c.branches) {
      if (branch == 0.0) continue;
      const double tiny = 1e-12 * c.p.rest_length;
      const double below = spring_tension(c.law, c.p, branch - tiny).tension,
                   above = spring_tension(c.law, c.p, branch + tiny).tension;
      EXPECT_NEAR(below, above,
                  1e-8 * std::abs(spring_tension(c.law, c.p, 0.3 * c.p.rest_length).tension) + 1e-9)
          << c.name;
    }
}

}  // namespace
}  // namespace taut
