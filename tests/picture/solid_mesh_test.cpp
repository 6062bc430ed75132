#include "taut/picture/solid_mesh.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "taut/base/error.h"

namespace taut {
namespace {

constexpr double pi = std::numbers::pi;

Isometry some_pose() {
  Isometry pose = Isometry::Identity();
  pose.rotate(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()));
  pose.pretranslate(Vec3(3, -2, 5));
  return pose;
}

const Vec3& corner(const SolidMesh& s, std::size_t triangle, std::size_t k) {
  return s.mesh.positions[static_cast<std::size_t>(s.mesh.triangles[triangle][k])];
}

// By the divergence theorem: positive only if the triangles face outwards.
double volume(const SolidMesh& s) {
  double sum = 0;
  for (std::size_t t = 0; t < s.mesh.triangles.size(); ++t)
    sum += corner(s, t, 0).dot(corner(s, t, 1).cross(corner(s, t, 2))) / 6;
  return sum;
}

double area(const SolidMesh& s) {
  double sum = 0;
  for (std::size_t t = 0; t < s.mesh.triangles.size(); ++t)
    sum +=
        0.5 * (corner(s, t, 1) - corner(s, t, 0)).cross(corner(s, t, 2) - corner(s, t, 0)).norm();
  return sum;
}

// Unit normals within 10 degrees of the triangle they belong to, texture coordinates in the unit
// square.
void expect_sound(const SolidMesh& s) {
  ASSERT_EQ(s.normals.size(), s.mesh.positions.size());
  ASSERT_EQ(s.mesh.texcoords.size(), s.mesh.positions.size());
  for (const Vec2& uv : s.mesh.texcoords) EXPECT_TRUE(uv.minCoeff() >= 0 && uv.maxCoeff() <= 1);
  for (std::size_t t = 0; t < s.mesh.triangles.size(); ++t) {
    const Vec3 facet = (corner(s, t, 1) - corner(s, t, 0)).cross(corner(s, t, 2) - corner(s, t, 0));
    for (const Index v : s.mesh.triangles[t]) {
      const Vec3& normal = s.normals[static_cast<std::size_t>(v)];
      EXPECT_NEAR(normal.norm(), 1, 1e-12);
      if (facet.norm() < 1e-12) continue;  // at the poles
      EXPECT_GT(normal.dot(facet.normalized()), std::cos(10 * pi / 180)) << "triangle " << t;
    }
  }
}

TEST(SolidMesh, ClosedSolidsHaveTheirVolumeAndArea) {
  const SolidMesh sphere = make_sphere_mesh(0.3, some_pose()),
                  cylinder = make_cylinder_mesh(0.3, 0.8, some_pose());
  const SolidMesh box = make_box_mesh(Vec3(0.2, 0.5, 1.5), some_pose());
  EXPECT_NEAR(volume(sphere) / (4.0 / 3.0 * pi * 0.027), 1, 3e-3);
  EXPECT_NEAR(area(sphere) / (4 * pi * 0.09), 1, 3e-3);
  EXPECT_NEAR(volume(cylinder) / (pi * 0.09 * 0.8), 1, 3e-3);
  EXPECT_NEAR(area(cylinder) / (2 * pi * 0.3 * (0.8 + 0.3)), 1, 3e-3);
  EXPECT_NEAR(volume(box), 0.15, 1e-12);
  EXPECT_NEAR(area(box), 2 * (0.1 + 0.3 + 0.75), 1e-12);
  for (const SolidMesh* s : {&sphere, &cylinder, &box}) expect_sound(*s);
}

TEST(SolidMesh, PlanePiecesFaceUpInTheirOwnFrame) {
  const SolidMesh disc = make_disc_mesh(2.0, some_pose()), quad = make_quad_mesh(3, 2, some_pose());
  EXPECT_NEAR(area(disc) / (4 * pi), 1, 3e-3);
  EXPECT_NEAR(area(quad), 6, 1e-12);
  for (const SolidMesh* s : {&disc, &quad}) {
    expect_sound(*s);
    for (const Vec3& n : s->normals)
      EXPECT_TRUE(n.isApprox(some_pose().linear() * Vec3::UnitZ(), 1e-12));
    for (const Vec3& p : s->mesh.positions) EXPECT_NEAR((some_pose().inverse() * p).z(), 0, 1e-12);
  }
}

TEST(SolidMesh, SphereVerticesLieOnTheSphere) {
  for (const int segments : {3, 8, 96})
    for (const Vec3& p : make_sphere_mesh(0.25, some_pose(), segments).mesh.positions)
      EXPECT_NEAR((p - some_pose().translation()).norm(), 0.25, 1e-12);
}

TEST(SolidMesh, BadSizesAreRefused) {
  EXPECT_THROW(make_sphere_mesh(-1), InputError);
  EXPECT_THROW(make_cylinder_mesh(1, std::numeric_limits<double>::quiet_NaN()), InputError);
  EXPECT_THROW(make_box_mesh(Vec3(1, -1, 1)), InputError);
  EXPECT_THROW(make_disc_mesh(1, Isometry::Identity(), 2), InputError);
}

}  // namespace
}  // namespace taut
