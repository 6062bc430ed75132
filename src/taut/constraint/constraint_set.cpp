#include "taut/constraint/constraint_set.h"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>

namespace taut {

namespace {

std::array<Vec3, 2> duff_complement(const Vec3& n) {
  // Duff et al. 2017: copysign removes the pole of Frisvad's construction.
  const double sign = std::copysign(1.0, n.z());
  const double a = -1.0 / (sign + n.z());
  const double b = n.x() * n.y() * a;
  return {Vec3(1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
          Vec3(b, sign + n.y() * n.y() * a, -n.y())};
}

std::array<Vec3, 2> paper_complement(const Vec3& p) {
  // Where s is exactly 0 the plane is that of the y and z axes (the paper has p1 = 1 only; p1 = -1
  // divides by zero there).
  const double s = std::sqrt(std::max(0.0, 1.0 - p.x() * p.x()));
  if (s == 0.0) return {Vec3::UnitY(), Vec3::UnitZ()};
  return {Vec3(s, -p.x() * p.y() / s, -p.x() * p.z() / s), Vec3(0.0, -p.z() / s, p.y() / s)};
}

}  // namespace

std::array<Vec3, 2> orthonormal_complement(const Vec3& n, FrameChoice choice) {
  return choice == FrameChoice::duff ? duff_complement(n) : paper_complement(n);
}

void ConstraintSet::reset(Index nodes, FrameChoice choice) {
  choice_ = choice;
  ndof_.assign(static_cast<std::size_t>(nodes), 3);
  frame_.assign(static_cast<std::size_t>(nodes), Mat3::Identity());
  displacement_.assign(static_cast<std::size_t>(nodes), Vec3::Zero());
}

void ConstraintSet::constrain(Index i, const Vec3& n, double distance) {
  const double length = n.norm();
  assert(std::isfinite(length) && length > 0.0 && std::isfinite(distance));
  const Vec3 direction = n / length;
  // The part of the direction that is still free becomes a new constrained direction; its distance
  // is what the earlier ones leave over.
  const Vec3 remaining = free_part(i, direction);
  const double share = remaining.norm();
  if (share < parallel_tolerance) return;
  const Vec3 fresh = remaining / share;
  displacement_[i] += (distance / length - direction.dot(displacement_[i])) / share * fresh;

  Mat3& frame = frame_[i];
  switch (ndof_[i]) {
    case 3: {
      const auto [u1, u2] = orthonormal_complement(fresh, choice_);
      frame << u1, u2, fresh;
      ndof_[i] = 2;
      break;
    }
    case 2: {
      const Vec3 first = frame.col(2);
      frame << first.cross(fresh).normalized(), fresh, first;
      ndof_[i] = 1;
      break;
    }
    case 1:
      frame.setIdentity();
      ndof_[i] = 0;
      break;
    default:
      break;
  }
}

void ConstraintSet::fix(Index i, const Vec3& displacement) {
  assert(displacement.allFinite());
  ndof_[i] = 0;
  frame_[i].setIdentity();
  displacement_[i] = displacement;
}

void ConstraintSet::set_frame(Index i, int ndof, const Mat3& frame) {
  assert(ndof >= 0 && ndof <= 3 && (frame.transpose() * frame - Mat3::Identity()).norm() < 1e-9);
  ndof_[i] = static_cast<std::int8_t>(ndof);
  frame_[i] = ndof == 1 || ndof == 2 ? frame : Mat3(Mat3::Identity());
  displacement_[i].setZero();
}

Mat3 ConstraintSet::projection(Index i) const {
  switch (ndof_[i]) {
    case 3:
      return Mat3::Identity();
    case 2:
      return frame_[i].leftCols<2>() * frame_[i].leftCols<2>().transpose();
    case 1:
      return frame_[i].col(0) * frame_[i].col(0).transpose();
    default:
      return Mat3::Zero();
  }
}

Vec3 ConstraintSet::free_part(Index i, const Vec3& a) const {
  switch (ndof_[i]) {
    case 3:
      return a;
    case 2:
      return frame_[i].leftCols<2>() * (frame_[i].leftCols<2>().transpose() * a);
    case 1:
      return frame_[i].col(0) * frame_[i].col(0).dot(a);
    default:
      return Vec3::Zero();
  }
}

Index ConstraintSet::free_dofs() const {
  Index total = 0;
  for (const auto n : ndof_) total += n;
  return total;
}

}  // namespace taut
