#include "taut/contact/proximity.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <random>

#include "moving_pairs.h"

namespace taut {

namespace {

// A pair of closest points of two convex shapes is known by this: the planes through them,
// orthogonal to their connection, have all corners of either shape on the far side. `slack` (m) is
// what rounding may add.
void expect_between(const Vec3& from, const Vec3& to, std::initializer_list<Vec3> from_corners,
                    std::initializer_list<Vec3> to_corners, double slack) {
  const Vec3 connection = to - from;
  const double length = connection.norm();
  if (length <= slack) return;
  for (const Vec3& corner : from_corners) EXPECT_LE(connection.dot(corner - from) / length, slack);
  for (const Vec3& corner : to_corners) EXPECT_GE(connection.dot(corner - to) / length, -slack);
}

double size_of(std::initializer_list<Vec3> corners) {
  double size = 0.0;
  for (const Vec3& corner : corners) size = std::max(size, corner.norm());
  return size;
}

void check_point_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const PointTriangleProximity found = closest_point_triangle(p, a, b, c);
  const double slack = 2e-8 * size_of({p, a, b, c});  // angles below 1e-8 count as degenerate
  EXPECT_NEAR(found.weights[0] + found.weights[1] + found.weights[2], 1.0, 1e-14);
  for (const double w : found.weights) EXPECT_GE(w, 0.0);
  const Vec3 q = found.weights[0] * a + found.weights[1] * b + found.weights[2] * c;
  EXPECT_NEAR(found.distance, (p - q).norm(), slack);
  EXPECT_NEAR(found.normal.norm(), 1.0, 1e-14);
  if (found.distance > 1e3 * slack) {
    EXPECT_GT(found.normal.dot(p - q), (1 - 1e-6) * found.distance);
  }
  expect_between(q, p, {a, b, c}, {p}, slack);
  EXPECT_NEAR(
      found.distance,
      static_cast<double>(test::triangle_distance(p.cast<long double>(), a.cast<long double>(),
                                                  b.cast<long double>(), c.cast<long double>())),
      slack);
}

void check_edge_edge(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const EdgeEdgeProximity found = closest_edge_edge(a, b, c, d);
  const double slack = 2e-8 * size_of({a, b, c, d});
  EXPECT_TRUE(found.s >= 0.0 && found.s <= 1.0 && found.t >= 0.0 && found.t <= 1.0);
  const Vec3 r = a + found.s * (b - a), q = c + found.t * (d - c);
  EXPECT_NEAR(found.distance, (r - q).norm(), slack);
  EXPECT_NEAR(found.normal.norm(), 1.0, 1e-14);
  if (found.distance > 1e3 * slack) {
    EXPECT_GT(found.normal.dot(r - q), (1 - 1e-6) * found.distance);
  }
  expect_between(q, r, {c, d}, {a, b}, slack);
  EXPECT_NEAR(
      found.distance,
      static_cast<double>(test::edge_distance(a.cast<long double>(), b.cast<long double>(),
                                              c.cast<long double>(), d.cast<long double>())),
      slack);
}

std::array<Vec3, 4> four_points(std::mt19937& random, int kind, double scale) {
  std::uniform_real_distribution<double> uniform(-scale, scale);
  std::uniform_int_distribution<int> grid(-2, 2);
  std::array<Vec3, 4> x;
  for (Vec3& corner : x)
    corner = kind == 0 ? Vec3(uniform(random), uniform(random), uniform(random))
                       : Vec3(scale * grid(random), scale * grid(random), scale * grid(random));
  // a short side
  if (kind == 2) x[3] = x[2] + 1e-9 * (x[3] - x[2]);
  // parallel edges
  if (kind == 3) x[3] = x[2] + (x[1] - x[0]) * 0.7 + 1e-12 * (x[3] - x[2]);
  // a sliver
  if (kind == 4) x[3] = x[1] + 0.4 * (x[2] - x[1]) + 1e-11 * scale * Vec3(1.0, -1.0, 0.5);
  return x;
}

}  // namespace

TEST(Proximity, ClosestPointsAreClosest) {
  std::mt19937 random(7);
  for (int kind = 0; kind < 5; ++kind)
    for (const double scale : {1.0, 1e-6, 1e5})
      for (int k = 0; k < 3000; ++k) {
        const auto [a, b, c, d] = four_points(random, kind, scale);
        check_point_triangle(a, b, c, d);
        check_edge_edge(a, b, c, d);
        if (HasFailure()) FAIL() << "kind " << kind << " scale " << scale << " k " << k;
      }
}

TEST(Proximity, KnownCases) {
  const Vec3 a(0, 0, 0), b(2, 0, 0), c(0, 2, 0);
  const PointTriangleProximity above = closest_point_triangle({0.5, 0.5, 3.0}, a, b, c);
  EXPECT_NEAR(above.distance, 3.0, 1e-15);
  EXPECT_LT((above.normal - Vec3::UnitZ()).norm(), 1e-15);
  EXPECT_NEAR(above.weights[0], 0.5, 1e-15);
  const PointTriangleProximity below = closest_point_triangle({0.5, 0.5, -3.0}, a, b, c);
  EXPECT_LT((below.normal + Vec3::UnitZ()).norm(), 1e-15);
  const PointTriangleProximity beyond = closest_point_triangle({2.0, 2.0, 0.0}, a, b, c);
  EXPECT_NEAR(beyond.distance, std::sqrt(2.0), 1e-15);
  EXPECT_LT((beyond.normal - Vec3(1, 1, 0).normalized()).norm(), 1e-15);

  const EdgeEdgeProximity cross = closest_edge_edge({-1, 0, 1}, {1, 0, 1}, {0, -1, 0}, {0, 1, 0});
  EXPECT_NEAR(cross.distance, 1.0, 1e-15);
  EXPECT_NEAR(cross.s, 0.5, 1e-15);
  EXPECT_NEAR(cross.t, 0.5, 1e-15);
  EXPECT_LT((cross.normal - Vec3::UnitZ()).norm(), 1e-15);
}

// At no distance there is still a normal: that of what meets.
TEST(Proximity, NormalWhereTheyTouch) {
  const Vec3 a(0, 0, 0), b(2, 0, 0), c(0, 2, 0);
  for (const Vec3& p : {Vec3(0.5, 0.5, 0.0), a, b, c, Vec3(1.0, 0.0, 0.0), Vec3(1.0, 1.0, 0.0)}) {
    const PointTriangleProximity found = closest_point_triangle(p, a, b, c);
    EXPECT_EQ(found.distance, 0.0);
    EXPECT_LT((found.normal - Vec3::UnitZ()).norm(), 1e-15);
  }
  const EdgeEdgeProximity corner = closest_edge_edge(a, b, a, c);
  EXPECT_EQ(corner.distance, 0.0);
  EXPECT_LT((corner.normal - Vec3::UnitZ()).norm(), 1e-15);
  // All the same point, and pieces of one line.
  EXPECT_NEAR(closest_point_triangle(a, a, a, a).normal.norm(), 1.0, 1e-15);
  EXPECT_NEAR(closest_edge_edge(a, a, a, a).normal.norm(), 1.0, 1e-15);
  const EdgeEdgeProximity line = closest_edge_edge(a, b, b, Vec3(3, 0, 0));
  EXPECT_NEAR(line.normal.norm(), 1.0, 1e-15);
  EXPECT_NEAR(line.normal.x(), 0.0, 1e-15);
}

// Orthogonal to the face however near the point is: there, p - q is nothing but rounding.
TEST(Proximity, NormalIsOrthogonalWhereTheGapIsLost) {
  const Vec3 a(0.1, 0.2, 0.3), b(0.7, 0.1, 0.4), c(0.3, 0.9, 0.2);
  const Vec3 n = (b - a).cross(c - a).normalized();
  for (const double gap : {1e-9, 1e-13, 1e-15}) {
    const PointTriangleProximity found =
        closest_point_triangle(Vec3((a + b + c) / 3.0 + gap * n), a, b, c);
    EXPECT_NEAR(std::abs(found.normal.dot(n)), 1.0, 1e-14);
    const PointTriangleProximity at_side =
        closest_point_triangle(Vec3(0.5 * (a + b) + gap * n.cross(a - b).normalized()), a, b, c);
    EXPECT_NEAR(at_side.normal.dot(b - a), 0.0, 1e-15);
  }
}

}  // namespace taut
