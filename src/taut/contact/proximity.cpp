#include "taut/contact/proximity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace taut {

namespace {

// sin² of the angle below which two directions have no cross product worth the name: its relative
// error is u / sin.
constexpr double parallel_sine2 = 1e-16;
// Squares below this have lost digits to underflow.
constexpr double smallest_square = 1e-280;

bool is_normal(double n2, const Vec3& e, const Vec3& f) {
  return n2 > parallel_sine2 * e.squaredNorm() * f.squaredNorm() && n2 > smallest_square;
}

Vec3 any_orthogonal(const Vec3& e) {
  Index least;
  if (e.cwiseAbs().maxCoeff() == 0.0) return Vec3::UnitZ();
  e.cwiseAbs().minCoeff(&least);
  return e.cross(Vec3::Unit(least)).normalized();
}

// The closest point of the segment from 0 to e to the point w: at `at` e, w - at e = `offset`, of
// squared length `squared_distance`.
struct OnSegment {
  double at;
  Vec3 offset;
  double squared_distance;
};

OnSegment closest_on_segment(const Vec3& w, const Vec3& e) {
  const double length2 = e.squaredNorm();
  const double along = w.dot(e);
  if (!(along > 0.0)) return {0.0, w, w.squaredNorm()};
  if (along >= length2) {
    const Vec3 offset = w - e;
    return {1.0, offset, offset.squaredNorm()};
  }
  const double at = along / length2;
  Vec3 offset = w - at * e;
  // What the first subtraction left along e is rounding of w; the second removes it, so that the
  // offset is orthogonal to its own accuracy.
  offset -= (offset.dot(e) / length2) * e;
  return {at, offset, offset.squaredNorm()};
}

// The direction of `offset`, if it has one.
bool direction_of(const Vec3& offset, double squared_length, Vec3& normal) {
  if (squared_length > smallest_square) {
    normal = offset / std::sqrt(squared_length);
    return true;
  }
  const double largest = offset.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return false;
  normal = (offset / largest).normalized();  // in two steps, since its square underflows
  return normal.allFinite();
}

}  // namespace

PointTriangleProximity closest_point_triangle(const Vec3& ap, const Vec3& ab, const Vec3& ac) {
  PointTriangleProximity result;
  const Vec3 n = ab.cross(ac);
  const double n2 = n.squaredNorm();
  const bool has_normal = is_normal(n2, ab, ac);
  if (has_normal) {
    const double wb = ap.cross(ac).dot(n), wc = ab.cross(ap).dot(n);
    if (wb >= 0.0 && wc >= 0.0 && wb + wc <= n2) {
      const double length = std::sqrt(n2), height = n.dot(ap) / length;
      result.distance = std::abs(height);
      result.normal = n / (height < 0.0 ? -length : length);
      result.weights = {std::max(0.0, 1.0 - (wb + wc) / n2), wb / n2, wc / n2};
      return result;
    }
  }
  const OnSegment sides[3] = {closest_on_segment(ap, ab), closest_on_segment(ap, ac),
                              closest_on_segment(ap - ab, ac - ab)};
  int nearest = 0;
  for (int k = 1; k < 3; ++k)
    if (sides[k].squared_distance < sides[nearest].squared_distance) nearest = k;
  const OnSegment& side = sides[nearest];
  result.distance = std::sqrt(side.squared_distance);
  if (!direction_of(side.offset, side.squared_distance, result.normal))
    result.normal = has_normal ? Vec3(n / std::sqrt(n2))
                               : any_orthogonal(nearest == 0   ? ab
                                                : nearest == 1 ? ac
                                                               : Vec3(ac - ab));
  if (nearest == 0) result.weights = {1.0 - side.at, side.at, 0.0};
  if (nearest == 1) result.weights = {1.0 - side.at, 0.0, side.at};
  if (nearest == 2) result.weights = {0.0, 1.0 - side.at, side.at};
  return result;
}

PointTriangleProximity closest_point_triangle(const Vec3& p, const Vec3& a, const Vec3& b,
                                              const Vec3& c) {
  return closest_point_triangle(p - a, b - a, c - a);
}

EdgeEdgeProximity closest_edge_edge(const Vec3& ca, const Vec3& ab, const Vec3& cd) {
  EdgeEdgeProximity result;
  const Vec3 n = ab.cross(cd);
  const double n2 = n.squaredNorm();
  const bool has_normal = is_normal(n2, ab, cd);
  if (has_normal) {
    const double s = cd.cross(ca).dot(n), t = ab.cross(ca).dot(n);
    if (s >= 0.0 && s <= n2 && t >= 0.0 && t <= n2) {
      const double length = std::sqrt(n2), height = n.dot(ca) / length;
      result.distance = std::abs(height);
      result.normal = n / (height < 0.0 ? -length : length);
      result.s = s / n2;
      result.t = t / n2;
      return result;
    }
  }
  // Not two inner points, so a corner of one edge: a, b against cd; c, d against ab.
  const OnSegment corners[4] = {closest_on_segment(ca, cd), closest_on_segment(ca + ab, cd),
                                closest_on_segment(-ca, ab), closest_on_segment(cd - ca, ab)};
  int nearest = 0;
  for (int k = 1; k < 4; ++k)
    if (corners[k].squared_distance < corners[nearest].squared_distance) nearest = k;
  const OnSegment& corner = corners[nearest];
  result.distance = std::sqrt(corner.squared_distance);
  const Vec3 offset = nearest < 2 ? corner.offset : Vec3(-corner.offset);
  if (!direction_of(offset, corner.squared_distance, result.normal)) {
    const Vec3& side = ab.squaredNorm() > cd.squaredNorm() ? ab : cd;
    result.normal = has_normal ? Vec3(n / std::sqrt(n2)) : any_orthogonal(side);
  }
  result.s = nearest == 0 ? 0.0 : nearest == 1 ? 1.0 : corner.at;
  result.t = nearest == 2 ? 0.0 : nearest == 3 ? 1.0 : corner.at;
  return result;
}

EdgeEdgeProximity closest_edge_edge(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return closest_edge_edge(a - c, b - a, d - c);
}

}  // namespace taut
