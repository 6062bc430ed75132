#include "taut/contact/rigid_motion.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double most_turn = 1.0;  // rad
constexpr int newton_limit = 30;

Mat3 turn_by(const Vec3& angle_vector) {
  const double angle = angle_vector.norm();
  return angle > 0.0 ? Mat3(Eigen::AngleAxisd(angle, angle_vector / angle).toRotationMatrix())
                     : Mat3(Mat3::Identity());
}

// sum m r × a r for a = R J: twice the axial vector of its antisymmetric part.
Vec3 twist_of(const Mat3& a) { return {a(2, 1) - a(1, 2), a(0, 2) - a(2, 0), a(1, 0) - a(0, 1)}; }

// Nodes on a line have no inertia about it, nor momentum: the least of the solutions.
Vec3 least_solution(const Mat3& h, const Vec3& rhs) {
  Eigen::CompleteOrthogonalDecomposition<Mat3> decomposition;
  decomposition.setThreshold(1e-10);
  return decomposition.compute(h).solve(rhs);
}

std::optional<Mat3> discrete_turn(const Mat3& j, const Vec3& momentum) {
  Mat3 rotation = Mat3::Identity();
  const double accurate = 1e-14 * j.trace();
  for (int k = 0; k < newton_limit; ++k) {
    const Mat3 turned = rotation * j;
    const Vec3 missing = momentum - twist_of(turned);
    const Vec3 step = least_solution(turned.trace() * Mat3::Identity() - turned, missing);
    if (!step.allFinite() || step.norm() > most_turn) return {};
    rotation = turn_by(step) * rotation;
    if (missing.norm() <= accurate || step.norm() < 1e-15)
      return Eigen::AngleAxisd(rotation).angle() <= most_turn ? std::optional(rotation)
                                                              : std::nullopt;
  }
  return {};
}

Vec3 centre(std::span<const Vec3> x, std::span<const double> weight) {
  Vec3 sum = Vec3::Zero();
  double total = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double w = weight.empty() ? 1.0 : weight[i];
    sum += w * x[i];
    total += w;
  }
  return sum / total;
}

// Kabsch: the turn that fits best, and none about directions of which the points know nothing.
Mat3 best_turn(const Mat3& covariance) {
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vec3 s = svd.singularValues();
  if (s[0] == 0.0) return Mat3::Identity();
  if (s[1] < 1e-9 * s[0])
    return Eigen::Quaterniond::FromTwoVectors(Vec3(svd.matrixV().col(0)),
                                              Vec3(svd.matrixU().col(0)))
        .toRotationMatrix();
  Mat3 mirror = Mat3::Identity();
  mirror(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * mirror * svd.matrixV().transpose();
}

}  // namespace

double RigidMotion::angle() const { return Eigen::AngleAxisd(rotation).angle(); }

RigidMotion momentum_keeping_motion(std::span<const Vec3> x0, std::span<const Vec3> x1,
                                    std::span<const double> mass) {
  RigidMotion motion;
  motion.from = centre(x0, mass);
  motion.to = centre(x1, mass);
  Mat3 j = Mat3::Zero();
  Vec3 momentum = Vec3::Zero();
  for (std::size_t i = 0; i < x0.size(); ++i) {
    const Vec3 r = x0[i] - motion.from;
    j += mass[i] * r * r.transpose();
    momentum += mass[i] * r.cross(x1[i] - motion.to);
  }
  if (const auto rotation = discrete_turn(j, momentum)) {
    motion.rotation = *rotation;
    return motion;
  }
  motion.exact = false;
  const Vec3 turn = least_solution(j.trace() * Mat3::Identity() - j, momentum);
  motion.rotation = turn.allFinite() ? turn_by(turn * std::min(1.0, most_turn / turn.norm()))
                                     : Mat3(Mat3::Identity());
  return motion;
}

std::optional<RigidMotion> motion_through(std::span<const Vec3> x0, std::span<const Vec3> x1,
                                          double tolerance) {
  RigidMotion motion;
  motion.from = centre(x0, {});
  motion.to = centre(x1, {});
  const auto fits = [&] {
    for (std::size_t i = 0; i < x0.size(); ++i)
      if ((motion(x0[i]) - x1[i]).norm() > tolerance) return false;
    return true;
  };
  if (fits()) return motion;
  Mat3 covariance = Mat3::Zero();
  for (std::size_t i = 0; i < x0.size(); ++i)
    covariance += (x1[i] - motion.to) * (x0[i] - motion.from).transpose();
  motion.rotation = best_turn(covariance);
  if (!fits() || motion.angle() > most_turn) return {};
  return motion;
}

}  // namespace taut
