// Gravity, drag and wind against closed forms, their damping against finite differences.

#include "taut/element/external.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "element/finite_difference.h"
#include "element/random_springs.h"
#include "taut/mesh/grid.h"
#include "taut/mesh/topology.h"

namespace taut {
namespace {

const Vec3 gravity(0.3, -0.4, -9.81);

TEST(ExternalForces, GravityIsMassTimesAccelerationAndNothingElse) {
  ExternalForces external({0.1, 2.5}, gravity, {});
  const std::vector<Vec3> x(2, Vec3::Zero()), v(2, Vec3(7, 8, 9));
  external.evaluate(0.0, x, v);
  EXPECT_LT((external.force()[0] - 0.1 * gravity).norm(), 1e-16);
  EXPECT_LT((external.force()[1] - 2.5 * gravity).norm(), 1e-15);
  EXPECT_TRUE(external.damping().empty());
}

TEST(ExternalForces, DragFollowsTheAir) {
  ExternalForces external({0.1, 0.2}, Vec3::Zero(), {.velocity = Vec3(3, 0, 1)});
  external.set_drag(1, 0.5);
  const std::vector<Vec3> x(2, Vec3::Zero()), v(2, Vec3(1, 2, 3));
  external.evaluate(0.0, x, v);
  EXPECT_EQ(external.force()[0], Vec3(Vec3::Zero()));
  EXPECT_LT((external.force()[1] - Vec3(1, -1, -1)).norm(), 1e-15);
  EXPECT_EQ(external.damping()[0], Mat3(Mat3::Zero()));
  EXPECT_EQ(external.damping()[1], Mat3(0.5 * Mat3::Identity()));
}

TEST(ExternalForces, GustsComeAndGo) {
  const WindOptions wind{.velocity = Vec3(2, 0, -1), .gust = 0.3, .gust_frequency = 0.5};
  EXPECT_LT((wind.at(0.0) - wind.velocity).norm(), 1e-15);
  EXPECT_LT((wind.at(0.5) - 1.3 * wind.velocity).norm(), 1e-15);
  EXPECT_LT((wind.at(1.5) - 0.7 * wind.velocity).norm(), 1e-14);
  EXPECT_LT((wind.at(1.0 / 6.0) - 1.15 * wind.velocity).norm(), 1e-14);
  ExternalForces external({1.0}, Vec3::Zero(), wind);
  external.set_drag(0, 1.0);
  const std::vector<Vec3> still(1, Vec3::Zero());
  external.evaluate(0.5, still, still);
  EXPECT_LT((external.force()[0] - 1.3 * wind.velocity).norm(), 1e-14);
}

// On a flat sheet of area A and normal n at rest: c A (n·w) n in all; each node has its share of
// the area.
TEST(ExternalForces, WindPressureOnAFlatSquare) {
  const Vec3 n = Vec3(1, 2, -2) / 3.0;
  const Vec3 u = 0.5 * Vec3(2, 1, 2) / 3.0, v = 0.8 * n.cross(Vec3(2, 1, 2) / 3.0);
  const GridShape shape{.nu = 5, .nv = 4, .origin = Vec3(1, 1, 1), .u = u, .v = v};
  TriangleMesh mesh = make_grid(shape);
  const double pressure = 0.7, area = 0.5 * 0.8;
  const Vec3 wind(3, -1, 2);
  ExternalForces external(std::vector<double>(20, 1.0), Vec3::Zero(), {.velocity = wind});
  external.add_wind_surface(mesh.triangles, pressure);
  const std::vector<Vec3> still(20, Vec3::Zero());
  external.evaluate(0.0, mesh.positions, still);
  const std::vector<double> shares = vertex_areas(mesh);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < 20; ++i) {
    sum += external.force()[i];
    EXPECT_LT((external.force()[i] - pressure * shares[i] * n.dot(wind) * n).norm(), 1e-15);
  }
  EXPECT_LT((sum - pressure * area * n.dot(wind) * n).norm(), 1e-14);
  // Carried along with the air it feels nothing.
  external.evaluate(0.0, mesh.positions, std::vector<Vec3>(20, wind));
  for (const Vec3& f : external.force()) EXPECT_EQ(f, Vec3(Vec3::Zero()));
}

TEST(ExternalForces, DampingIsMinusTheVelocityGradient) {
  test::Random random(3);
  const GridShape shape{.nu = 4, .nv = 3};
  TriangleMesh mesh = make_grid(shape);
  for (Vec3& place : mesh.positions) place += random.vector(0.1);
  ExternalForces external(std::vector<double>(12, 0.1), gravity,
                          {.velocity = Vec3(4, 1, 0), .gust = 0.4});
  for (Index i = 0; i < 12; ++i) external.set_drag(i, 0.01 * i);
  external.add_wind_surface(mesh.triangles, 0.9);
  const std::vector<Vec3> v = random.vectors(12, 2.0);
  external.evaluate(0.3, mesh.positions, v);
  const std::vector<Mat3> damping(external.damping().begin(), external.damping().end());
  for (std::size_t i = 0; i < 12; ++i) {
    const auto force = [&](const Vec3& a) {
      std::vector<Vec3> changed = v;
      changed[i] = a;
      external.evaluate(0.3, mesh.positions, changed);
      return Vec3(external.force()[i]);
    };
    EXPECT_LT((test::numeric_jacobian(force, v[i], 1e-2) + damping[i]).norm(), 1e-11)
        << "node " << i;
    EXPECT_EQ(damping[i], Mat3(damping[i].transpose()));
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Mat3>(damping[i]).eigenvalues()[0], -1e-15);
  }
}

TEST(ExternalForces, TriangleOfNoAreaFeelsNoWind) {
  const std::vector<Triangle> triangles{{0, 1, 2}};
  ExternalForces external(std::vector<double>(3, 1.0), Vec3::Zero(), {.velocity = Vec3(1, 1, 1)});
  external.add_wind_surface(triangles, 1.0);
  const std::vector<Vec3> line{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)}, still(3, Vec3::Zero());
  external.evaluate(0.0, line, still);
  for (const Vec3& f : external.force()) EXPECT_EQ(f, Vec3(Vec3::Zero()));
}

}  // namespace
}  // namespace taut
