#include "taut/constraint/constraint_set.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace taut {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

Mat3 frame_of(const Vec3& n, FrameChoice choice) {
  const auto [u1, u2] = orthonormal_complement(n, choice);
  Mat3 frame;
  frame << u1, u2, n;
  return frame;
}

double orthonormality_error(const Mat3& frame) {
  return (frame.transpose() * frame - Mat3::Identity()).cwiseAbs().maxCoeff();
}

// The whole sphere, with the six poles, and around the poles of all axes at distances from 1e-16 to
// 1e-3 (as 1 - |p|) and sqrt of these.
std::vector<Vec3> directions() {
  std::vector<Vec3> all;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      all.push_back(sign * Vec3::Unit(axis));
      for (double defect = 1e-16; defect < 2e-3; defect *= 10.0)
        for (int k = 0; k < 12; ++k) {
          const double angle = 2 * std::numbers::pi * k / 12 + 0.1, s = std::sqrt(2.0 * defect);
          Vec3 n;
          n[axis] = sign * (1.0 - defect);
          n[(axis + 1) % 3] = s * std::cos(angle);
          n[(axis + 2) % 3] = s * std::sin(angle);
          all.push_back(n.normalized());
        }
    }
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 20000; ++k)
    all.push_back(Vec3(normal(random), normal(random), normal(random)).normalized());
  return all;
}

TEST(OrthonormalComplement, duffHasNoBadDirection) {
  for (const Vec3& n : directions())
    ASSERT_LT(orthonormality_error(frame_of(n, FrameChoice::duff)), 1e-12) << n.transpose();
  for (const double z : {0.0, -0.0})
    EXPECT_LT(orthonormality_error(frame_of(Vec3(1, 0, z), FrameChoice::duff)), 1e-15);
}

TEST(OrthonormalComplement, paperEq13LosesDigitsOnlyNearItsPoles) {
  for (const Vec3& n : directions()) {
    // Rounding of 1 - p1² is divided by s²: the error is that of the unit vector, epsilon, over s².
    const double s2 = n.y() * n.y() + n.z() * n.z();
    const double error = orthonormality_error(frame_of(n, FrameChoice::paper_eq13));
    ASSERT_TRUE(std::isfinite(error)) << n.transpose();
    if (s2 > 8 * epsilon) {
      ASSERT_LT(error, 8 * epsilon / s2) << n.transpose();
    }
  }
  EXPECT_EQ(orthonormality_error(frame_of(Vec3(1, 0, 0), FrameChoice::paper_eq13)), 0.0);
  // the printed formula divides by zero here
  EXPECT_EQ(orthonormality_error(frame_of(Vec3(-1, 0, 0), FrameChoice::paper_eq13)), 0.0);
}

TEST(OrthonormalComplement, paperEq13AsPrinted) {
  const Vec3 p = Vec3(0.6, -0.48, 0.64);
  const auto [u1, u2] = orthonormal_complement(p, FrameChoice::paper_eq13);
  EXPECT_LT((u1 - Vec3(0.8, 0.36, -0.48)).norm(), 1e-15);
  EXPECT_LT((u2 - Vec3(0.0, -0.8, -0.6)).norm(), 1e-15);
}

TEST(ConstraintSet, projectionIsUUTransposedForEveryNdof) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  for (const FrameChoice choice : {FrameChoice::duff, FrameChoice::paper_eq13})
    for (const Vec3& first : directions()) {
      const double s2 = first.y() * first.y() + first.z() * first.z();
      // where it loses digits, see above
      if (choice == FrameChoice::paper_eq13 && s2 > 0.0 && s2 < 1e-4) continue;
      ConstraintSet set(1, choice);
      for (int ndof = 3; ndof >= 0; --ndof) {
        ASSERT_EQ(set.ndof(0), ndof);
        Mat3 projection = Mat3::Zero();
        for (int c = 0; c < ndof; ++c)
          projection += set.frame(0).col(c) * set.frame(0).col(c).transpose();
        ASSERT_LT((set.projection(0) - projection).norm(), 1e-12);
        ASSERT_LT(orthonormality_error(set.frame(0)), 1e-11);
        const Vec3 a = vector();
        ASSERT_LT((set.free_part(0, a) - set.projection(0) * a).norm(), 1e-12);
        ASSERT_LT((set.free_part(0, a) + set.constrained_part(0, a) - a).norm(), 1e-14);
        ASSERT_LT(set.free_part(0, set.displacement(0)).norm(),
                  1e-11 * (1 + set.displacement(0).norm()));
        if (ndof == 3) set.constrain(0, 2.5 * first, 0.3);
        if (ndof < 3 && ndof > 0) {
          const int before = set.ndof(0);
          while (set.ndof(0) == before) set.constrain(0, vector(), 0.1);
        }
      }
    }
}

TEST(ConstraintSet, everyNormalIsSatisfiedWhateverTheirAngles) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  int full = 0;
  for (int k = 0; k < 3000; ++k) {
    ConstraintSet set(1);
    const int count = 1 + k % 3;
    std::vector<Vec3> normals;
    std::vector<double> distances;
    Mat3 rows = Mat3::Identity();
    for (int c = 0; c < count; ++c) {
      normals.push_back(vector());
      distances.push_back(0.01 * normal(random));
      rows.row(c) = normals.back().normalized();
    }
    if (count == 3 && std::abs(rows.determinant()) < 0.05) continue;
    if (count == 2 && normals[0].normalized().cross(normals[1].normalized()).norm() < 0.05)
      continue;
    for (int c = 0; c < count; ++c) set.constrain(0, normals[c], distances[c]);
    ASSERT_EQ(set.ndof(0), 3 - count);
    for (int c = 0; c < count; ++c)
      ASSERT_NEAR(normals[c].dot(set.displacement(0)), distances[c], 1e-12);
    // No more than what is prescribed: the displacement of least length.
    for (int c = 0; c < set.ndof(0); ++c)
      ASSERT_NEAR(set.frame(0).col(c).dot(set.displacement(0)), 0.0, 1e-13);
    for (int c = 0; c < count; ++c)
      ASSERT_LT(set.free_part(0, normals[c]).norm(), 1e-12 * normals[c].norm() / 0.05);
    full += count == 3;
  }
  EXPECT_GT(full, 500);
}

TEST(ConstraintSet, closedFormOfTwoNormalsAt60Degrees) {
  ConstraintSet set(1);
  const Vec3 n1(0, 0.5, std::sqrt(0.75)), n2(0, -0.5, std::sqrt(0.75));
  set.constrain(0, n1, 0.01);
  set.constrain(0, n2, 0.03);
  EXPECT_EQ(set.ndof(0), 1);
  EXPECT_LT((set.displacement(0) - Vec3(0, -0.02, 0.04 / (2 * std::sqrt(0.75)))).norm(), 1e-15);
  EXPECT_NEAR(std::abs(set.frame(0)(0, 0)), 1.0, 1e-15);
}

TEST(ConstraintSet, nearlyParallelNormalsMerge) {
  for (const double angle : {0.0, 1e-12, 0.9 * parallel_tolerance, 1.1 * parallel_tolerance, 0.01})
    for (const double sign : {1.0, -1.0}) {
      ConstraintSet set(1);
      set.constrain(0, Vec3::UnitZ(), 0.02);
      set.constrain(0, sign * Vec3(std::sin(angle), 0, std::cos(angle)), 0.05);
      const bool merged = angle < parallel_tolerance;
      EXPECT_EQ(set.ndof(0), merged ? 2 : 1) << angle;
      EXPECT_NEAR(set.displacement(0).z(), 0.02, 1e-15);
      if (merged) {
        EXPECT_EQ(set.displacement(0).x(), 0.0);
      }
    }
  // A third normal in the plane of the first two adds nothing either.
  ConstraintSet set(1);
  set.constrain(0, Vec3(1, 0, 0), 0.1);
  set.constrain(0, Vec3(1, 1, 0), 0.2);
  set.constrain(0, Vec3(-1, 2, 1e-4), 5.0);
  EXPECT_EQ(set.ndof(0), 1);
  EXPECT_LT((set.displacement(0) - Vec3(0.1, 0.1, 0)).norm(), 1e-15);
}

TEST(ConstraintSet, countsFreedoms) {
  ConstraintSet set(5);
  EXPECT_EQ(set.free_dofs(), 15);
  set.constrain(1, Vec3(1, 2, 3), 0.0);
  set.constrain(2, Vec3::UnitX(), 0.0);
  set.constrain(2, Vec3::UnitY(), 0.0);
  for (int axis = 0; axis < 3; ++axis) set.constrain(3, Vec3::Unit(axis), 0.5);
  set.fix(4, Vec3(1, 2, 3));
  EXPECT_EQ(set.free_dofs(), 3 + 2 + 1 + 0 + 0);
  EXPECT_EQ(set.constrained_dofs(), 9);
  EXPECT_LT((set.displacement(3) - Vec3::Constant(0.5)).norm(), 1e-15);
  ConstraintSet other(5);
  EXPECT_FALSE(set.same_pattern(other));
  other = set;
  EXPECT_TRUE(set.same_pattern(other));
  set.reset(5);
  EXPECT_EQ(set.free_dofs(), 15);
  EXPECT_EQ(set.displacement(4), Vec3(0, 0, 0));
}

TEST(ConstraintSet, fixedNodeStaysFixed) {
  ConstraintSet set(1);
  set.constrain(0, Vec3::UnitZ(), 9.0);
  set.fix(0, Vec3(1, 2, 3));
  set.constrain(0, Vec3::UnitX(), 7.0);
  EXPECT_EQ(set.ndof(0), 0);
  EXPECT_EQ(set.displacement(0), Vec3(1, 2, 3));
  EXPECT_EQ(set.projection(0), Mat3(Mat3::Zero()));
  EXPECT_EQ(set.free_part(0, Vec3(1, 1, 1)), Vec3(0, 0, 0));
}

}  // namespace
}  // namespace taut
