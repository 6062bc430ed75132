#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "contact/point_masses.h"
#include "taut/contact/solid_step.h"

namespace taut {
namespace {

constexpr double pi = std::numbers::pi;

// Points of the surface, and how far any surface point is from the nearest of them at most.
struct Samples {
  std::vector<Vec3> points;
  double spacing = 0.0;
};

void sample_rectangle(Samples& samples, const Vec3& corner, const Vec3& a, const Vec3& b, int n) {
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= n; ++k) samples.points.push_back(corner + a * i / n + b * k / n);
  samples.spacing = std::max(samples.spacing, 0.5 * std::hypot(a.norm(), b.norm()) / n);
}

Samples sample_box(const Vec3& size) {
  Samples samples;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-0.5, 0.5}) {
      const int u = (axis + 1) % 3, w = (axis + 2) % 3;
      Vec3 corner = -0.5 * size;
      corner[axis] = side * size[axis];
      sample_rectangle(samples, corner, size[u] * Vec3::Unit(u), size[w] * Vec3::Unit(w), 100);
    }
  return samples;
}

Samples sample_cylinder(double radius, double height) {
  Samples samples;
  const int around = 400, along = 100;
  for (int i = 0; i < around; ++i) {
    const Vec3 rim(radius * std::cos(2 * pi * i / around), radius * std::sin(2 * pi * i / around),
                   0.0);
    for (int k = 0; k <= along; ++k) {
      samples.points.push_back(rim + Vec3(0, 0, height * (double(k) / along - 0.5)));
      for (const double end : {-0.5, 0.5})
        samples.points.push_back(rim * k / along + Vec3(0, 0, end * height));
    }
  }
  samples.spacing = 0.5 * std::hypot(2 * pi * radius / around, std::max(height, radius) / along);
  return samples;
}

struct Case {
  Solid solid;
  Samples samples;
};

std::vector<Case> sampled_solids() {
  return {{test::box(Vec3(0.6, 0.4, 0.3)), sample_box(Vec3(0.6, 0.4, 0.3))},
          {test::cylinder(0.25, 0.5), sample_cylinder(0.25, 0.5)}};
}

bool inside(const Solid& solid, const Vec3& p) {
  if (solid.shape == SolidShape::box) return (p.cwiseAbs() - 0.5 * solid.size).maxCoeff() < 0.0;
  return p.head<2>().norm() < solid.radius && std::abs(p.z()) < 0.5 * solid.height;
}

TEST(ClosestSurface, distanceAgreesWithSamplesOfTheSurface) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  for (const auto& [solid, samples] : sampled_solids())
    for (int k = 0; k < 300; ++k) {
      const Vec3 p(uniform(random), uniform(random), uniform(random));
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec3& s : samples.points) nearest = std::min(nearest, (s - p).squaredNorm());
      nearest = std::sqrt(nearest);
      const double distance = closest_surface(solid, p).distance;
      EXPECT_EQ(distance < 0.0, inside(solid, p)) << p.transpose();
      // The nearest sample is no nearer than the surface, and at most a spacing further.
      EXPECT_LE(std::abs(distance), nearest + 1e-12) << p.transpose();
      EXPECT_GE(std::abs(distance), nearest - samples.spacing) << p.transpose();
    }
}

TEST(ClosestSurface, stepAlongTheNormalLandsOnTheSurface) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  for (const Solid& solid : {test::sphere(0.3), test::box(Vec3(0.6, 0.4, 0.3)),
                             test::cylinder(0.25, 0.5), test::plane(Vec3::UnitZ())})
    for (int k = 0; k < 2000; ++k) {
      const Vec3 p(uniform(random), uniform(random), uniform(random));
      const SurfacePoint nearest = closest_surface(solid, p);
      EXPECT_NEAR(nearest.normal.norm(), 1.0, 1e-14);
      EXPECT_EQ(surface_distance(solid, p), nearest.distance);
      EXPECT_NEAR(closest_surface(solid, p - nearest.distance * nearest.normal).distance, 0.0,
                  1e-14)
          << p.transpose();
    }
}

TEST(ClosestSurface, normalIsTheGradientOfTheDistance) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  const double e = 1e-6;
  for (const Solid& solid : {test::sphere(0.3), test::box(Vec3(0.6, 0.4, 0.3)),
                             test::cylinder(0.25, 0.5), test::plane(Vec3::UnitZ())}) {
    int compared = 0;
    for (int k = 0; k < 2000; ++k) {
      const Vec3 p(uniform(random), uniform(random), uniform(random));
      Vec3 gradient;
      for (int c = 0; c < 3; ++c)
        gradient[c] = (closest_surface(solid, p + e * Vec3::Unit(c)).distance -
                       closest_surface(solid, p - e * Vec3::Unit(c)).distance) /
                      (2 * e);
      // Inside a box or cylinder the gradient jumps on the medial axis; differences that straddle
      // it are not of length 1.
      if (std::abs(gradient.norm() - 1.0) > 1e-4) continue;
      ++compared;
      EXPECT_LT((gradient - closest_surface(solid, p).normal).norm(), 1e-3) << p.transpose();
    }
    EXPECT_GT(compared, 1980);
  }
}

TEST(ClosestSurface, normalsAreContinuousOutside) {
  std::mt19937 random(14);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  for (const Solid& solid : {test::box(Vec3(0.6, 0.4, 0.3)), test::cylinder(0.25, 0.5)})
    for (int k = 0; k < 5000; ++k) {
      const Vec3 p(uniform(random), uniform(random), uniform(random));
      const SurfacePoint here = closest_surface(solid, p);
      if (here.distance < 1e-2) continue;
      const Vec3 step = 1e-7 * Vec3(uniform(random), uniform(random), uniform(random));
      EXPECT_LT((closest_surface(solid, p + step).normal - here.normal).norm(),
                2.0 * step.norm() / here.distance + 1e-14);
    }
}

TEST(ClosestSurface, finiteWhereTheNormalIsNotUnique) {
  for (const Solid& solid :
       {test::sphere(0.3), test::box(Vec3(0.6, 0.6, 0.6)), test::cylinder(0.25, 0.5)})
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(-0.0, 0.0, -0.0), Vec3(0.3, 0.3, 0.3),
                          Vec3(0.25, 0, 0.25), Vec3(1e-200, 0, 0)}) {
      const SurfacePoint nearest = closest_surface(solid, p);
      EXPECT_TRUE(std::isfinite(nearest.distance));
      EXPECT_NEAR(nearest.normal.norm(), 1.0, 1e-14) << p.transpose();
    }
}

TEST(SolidPose, constantVelocityAndTurn) {
  Solid solid = test::sphere(0.2, 0.0, Vec3(1, 2, 3));
  solid.initial.rotation = Eigen::AngleAxisd(0.3, Vec3::UnitX());
  solid.velocity = Vec3(0.1, -0.2, 0.3);
  solid.angular_velocity = Vec3(0, 0, 2.0);
  const Pose pose = solid.pose(0.7);
  EXPECT_LT((pose.translation - Vec3(1.07, 1.86, 3.21)).norm(), 1e-15);
  const Mat3 expected =
      (Eigen::AngleAxisd(1.4, Vec3::UnitZ()) * Eigen::AngleAxisd(0.3, Vec3::UnitX()))
          .toRotationMatrix();
  EXPECT_LT((pose.rotation.toRotationMatrix() - expected).norm(), 1e-15);
}

TEST(SolidPose, keyFramesAreLinearAndSphericallyLinear) {
  Solid solid = test::box(Vec3::Ones());
  const Vec3 axis = Vec3(1, 2, -1).normalized();
  const auto turned = [&](double angle) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
  };
  solid.key_frames = {{1.0, {turned(0.2), Vec3(0, 0, 0)}},
                      {2.0, {turned(1.4), Vec3(1, 0, 2)}},
                      {4.0, {turned(1.0), Vec3(1, 4, 2)}}};
  const auto expect = [&](double time, double angle, const Vec3& place) {
    const Pose pose = solid.pose(time);
    EXPECT_LT(pose.rotation.angularDistance(turned(angle)), 1e-7) << time;
    EXPECT_LT((pose.rotation.toRotationMatrix() - turned(angle).toRotationMatrix()).norm(), 1e-14)
        << time;
    EXPECT_LT((pose.translation - place).norm(), 1e-15) << time;
  };
  expect(0.0, 0.2, Vec3(0, 0, 0));  // held before the first
  expect(1.0, 0.2, Vec3(0, 0, 0));
  expect(1.25, 0.5, Vec3(0.25, 0, 0.5));
  expect(2.0, 1.4, Vec3(1, 0, 2));
  expect(3.5, 1.1, Vec3(1, 3, 2));
  expect(4.0, 1.0, Vec3(1, 4, 2));
  expect(9.0, 1.0, Vec3(1, 4, 2));  // and after the last
}

TEST(SolidPose, shorterWayRoundAndJumps) {
  Solid solid = test::box(Vec3::Ones());
  Eigen::Quaterniond quarter(Eigen::AngleAxisd(0.5 * pi, Vec3::UnitZ()));
  quarter.coeffs() *= -1.0;  // the same rotation
  solid.key_frames = {{0.0, {}},
                      {1.0, {quarter, Vec3::Zero()}},
                      {1.0, {Eigen::Quaterniond::Identity(), Vec3(5, 0, 0)}}};
  EXPECT_LT(
      (solid.pose(0.5).rotation * Vec3::UnitX() - Vec3(std::sqrt(0.5), std::sqrt(0.5), 0)).norm(),
      1e-14);
  // two frames at one time: a jump, no division by zero
  EXPECT_EQ(solid.pose(1.0).translation, Vec3(5, 0, 0));
}

TEST(SolidStep, anchorIsWhereTheStraightPathEnters) {
  Solid ball = test::sphere(0.2, 0.0, Vec3(0, 0, 0.3));
  ball.velocity = Vec3(0, 1, 0);
  const double h = 0.1;
  const SolidStep step(ball, 0.0, h);
  // In the ball's frame the path runs from (0, 0.5, 0) to (0, -0.1, 0): it enters at y = 0.2.
  const Vec3 x0(0, 0.5, 0.3), x1(0, 0.0, 0.3);
  EXPECT_TRUE(step.meets(x0, x1, 0.0));
  EXPECT_LT((step.anchor(x0, x1, 1e-6) - Vec3(0, 0.2, 0)).norm(), 1e-14);
  EXPECT_LT((step.carried(step.anchor(x0, x1, 1e-6)) - Vec3(0, 0.3, 0.3)).norm(), 1e-14);
}

TEST(SolidStep, passageThroughThinPlateIsSeen) {
  const Solid plate = test::box(Vec3(1, 1, 0.01));  // a SolidStep keeps a reference to it
  const SolidStep step(plate, 0.0, 0.01);
  const Vec3 above(0.1, 0.1, 0.03), below(0.15, 0.1, -0.03), beside(0.8, 0.1, -0.03);
  EXPECT_TRUE(step.meets(above, below, 1e-6));
  EXPECT_TRUE(step.meets(below, above, -1e-6));
  EXPECT_FALSE(step.meets(above + Vec3(0.7, 0, 0), beside, 1e-6));
  const Vec3 anchor = step.anchor(above, below, 1e-6);
  EXPECT_NEAR(anchor.z(), 0.005, 1e-14);
  const LandingPlane plane = step.landing(below, anchor);
  EXPECT_EQ(plane.normal, Vec3::UnitZ());  // back to the side it came from
  EXPECT_NEAR(plane.gap, -0.035, 1e-14);
}

// Against dense sampling of paths: `meets` never overlooks an end inside, and never claims one.
TEST(SolidStep, meetsAgreesWithTheDistanceAtTheEnd) {
  std::mt19937 random(15);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  for (Solid solid : {test::sphere(0.3), test::box(Vec3(0.6, 0.4, 0.3)), test::cylinder(0.25, 0.5),
                      test::plane(Vec3(1, 2, 3))}) {
    solid.thickness = 0.01;
    solid.angular_velocity = Vec3(1, -2, 3);
    solid.velocity = Vec3(0.5, 0, -1);
    const SolidStep step(solid, 0.2, 0.05);
    int met = 0;
    for (int k = 0; k < 3000; ++k) {
      const Vec3 x0(uniform(random), uniform(random), uniform(random)),
          x1 = x0 + 0.1 * Vec3(uniform(random), uniform(random), uniform(random));
      const double gap = test::gap_of(solid, 0.25, x1);
      EXPECT_NEAR(step.end_gap(x1), gap, 1e-14);
      EXPECT_EQ(step.meets(x0, x1, 0.0), gap <= 0.0);
      met += gap <= 0.0;
    }
    EXPECT_GT(met, 100);
  }
}

}  // namespace
}  // namespace taut
