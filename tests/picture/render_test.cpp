#include "taut/picture/render.h"

#include <gtest/gtest.h>

#include "picture/picture_probe.h"
#include "taut/mesh/grid.h"
#include "taut/picture/solid_mesh.h"

namespace taut {
namespace {

using test::brightness_at;
using test::colour_at;
using test::small_picture;

const Vec3 from_below = -Vec3::UnitZ();

Isometry moved(const Vec3& translation) {
  Isometry pose = Isometry::Identity();
  pose.translation() = translation;
  return pose;
}

Surface matt(const SolidMesh& solid, const Colour& colour) {
  Surface surface = solid_surface(solid, colour);
  surface.gloss = 0.0;
  return surface;
}

TEST(Render, SphereHasItsColourAndItsExactOutline) {
  const SolidMesh ball = make_sphere_mesh(0.5);
  const Surface surface = matt(ball, Colour(0.8, 0.1, 0.1));
  const Camera camera{Vec3(0, -4, 0), Vec3::Zero(), Vec3::UnitZ(), 30.0};
  const RenderOptions options = small_picture(200, 200);
  const Image image = render({&surface, 1}, camera, options);

  const std::uint8_t* centre = image.pixel(100, 100);
  EXPECT_GT(centre[0], 120);
  EXPECT_LT(centre[1], 60);
  EXPECT_LT(centre[2], 60);
  const std::uint8_t* corner = image.pixel(0, 0);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(corner[k], 255.0 * options.background_top[k], 2.0);

  // The tangent cone of a sphere of radius r at distance d has the slope r / sqrt(d² - r²).
  const double radius = 100.0 * 0.5 / std::sqrt(16.0 - 0.25) / std::tan(15.0 * M_PI / 180.0);
  int red = 0;
  for (int x = 0; x < 200; ++x) red += image.pixel(x, 100)[0] > image.pixel(x, 100)[1] + 30 ? 1 : 0;
  EXPECT_NEAR(red, 2.0 * radius, 1.5);
}

TEST(Render, KeyLightFollowsTheCosineLaw) {
  const SolidMesh quad = make_quad_mesh(2, 2);
  const Surface surface = matt(quad, Colour::Constant(0.6));
  const Camera camera{Vec3(0, -1, 3), Vec3::Zero(), Vec3::UnitZ(), 30.0};
  RenderOptions options = small_picture();
  options.light_diameter_deg = 0;
  const auto lit_from = [&](const Vec3& direction) {
    options.light_direction = direction;
    return brightness_at(render({&surface, 1}, camera, options), camera, Vec3::Zero(), 10);
  };
  const double sky_only = lit_from(from_below);
  const double upright = lit_from(Vec3::UnitZ()) - sky_only;
  // 30 degrees above the plane
  const double slanting = lit_from(Vec3(std::sqrt(3.0), 0, 1)) - sky_only;
  EXPECT_GT(upright, 0.1);
  EXPECT_NEAR(slanting / upright, 0.5, 0.02);
}

TEST(Render, ShadowOnTheGroundIsWhereTheLightSaysAndDarker) {
  const SolidMesh ball = make_sphere_mesh(0.3, moved(Vec3(0, 0, 1.2)));
  const Surface surface = matt(ball, Colour::Constant(0.7));
  const Camera camera{Vec3(0, -5, 2.0), Vec3(0, 0, 0.4), Vec3::UnitZ(), 30.0};
  RenderOptions options = small_picture(320, 240);
  options.ground = 0.0;
  options.light_direction = Vec3(1, 0, 1);  // the shadow's centre lies at x = -1.2
  options.light_diameter_deg = 0;
  const Image sharp = render({&surface, 1}, camera, options);
  const double lit = brightness_at(sharp, camera, Vec3(1.2, 0, 0), 0);
  const double half_length = 0.3 * std::sqrt(2.0);
  EXPECT_LT(brightness_at(sharp, camera, Vec3(-1.2, 0, 0)), 0.75 * lit);
  EXPECT_LT(brightness_at(sharp, camera, Vec3(-1.2 - 0.9 * half_length, 0, 0), 0), 0.75 * lit);
  EXPECT_GT(brightness_at(sharp, camera, Vec3(-1.2 - 1.1 * half_length, 0, 0), 0), 0.9 * lit);
  EXPECT_GT(brightness_at(sharp, camera, Vec3(-1.2, -0.45, 0), 0), 0.9 * lit);

  options.light_diameter_deg = 25;
  const Image soft = render({&surface, 1}, camera, options);
  const Vec3 edge(-1.2 - 0.9 * half_length, 0, 0);
  EXPECT_GT(brightness_at(soft, camera, edge), 1.1 * brightness_at(sharp, camera, edge));
}

TEST(Render, EachSideOfTheClothShowsItsColour) {
  const SolidMesh quad = make_quad_mesh(1, 1);
  Surface cloth = surface_of(quad.mesh);
  cloth.front = Colour(0.1, 0.7, 0.1);
  cloth.back = Colour(0.1, 0.1, 0.7);
  const Camera above{Vec3(0, -0.5, 3), Vec3::Zero(), Vec3::UnitZ(), 30.0},
      below{Vec3(0, -0.5, -3), Vec3::Zero(), Vec3::UnitZ(), 30.0};
  const Vec3 front = colour_at(render({&cloth, 1}, above, small_picture()), above, Vec3::Zero());
  const Vec3 back = colour_at(render({&cloth, 1}, below, small_picture()), below, Vec3::Zero());
  EXPECT_GT(front.y(), 3 * front.z());
  EXPECT_GT(back.z(), 3 * back.y());
}

TEST(Render, LightFallsThroughTranslucentCloth) {
  const SolidMesh quad = make_quad_mesh(1, 1);
  Surface cloth = surface_of(quad.mesh);
  const Camera camera{Vec3(0, -0.5, 3), Vec3::Zero(), Vec3::UnitZ(), 30.0};
  RenderOptions options = small_picture();
  options.light_direction = from_below;
  const auto seen = [&](double translucency) {
    cloth.translucency = translucency;
    return brightness_at(render({&cloth, 1}, camera, options), camera, Vec3::Zero(), 8);
  };
  const double none = seen(0.0), some = seen(0.2), more = seen(0.4);
  EXPECT_GT(some, 1.1 * none);
  EXPECT_NEAR(more - none, 2.0 * (some - none), 0.1 * (some - none));
}

TEST(Render, CheckerFollowsTheTextureCoordinates) {
  const SolidMesh quad = make_quad_mesh(1, 1);
  Surface cloth = surface_of(quad.mesh);
  cloth.pattern = Pattern::checker;
  cloth.pattern_cells = Vec2(4, 2);
  const Camera camera{Vec3(0, -0.01, 3), Vec3::Zero(), Vec3::UnitY(), 30.0};
  const Image image = render({&cloth, 1}, camera, small_picture(320, 240));
  const auto cell = [&](int i, int j) {
    return brightness_at(image, camera, Vec3(-0.5 + (i + 0.5) / 4, -0.5 + (j + 0.5) / 2, 0));
  };
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 3; ++i) {
      const double light = (i + j) % 2 == 0 ? cell(i, j) : cell(i + 1, j),
                   dark = (i + j) % 2 == 0 ? cell(i + 1, j) : cell(i, j);
      EXPECT_NEAR(dark / light, 0.62, 0.04) << "cells " << i << ", " << j;
    }
}

// Vertex normals made from the triangles must shade a coarse ball nearly as its exact normals do;
// facets must not.
TEST(Render, SmoothNormalsAreThoseOfTheSurface) {
  const SolidMesh ball = make_sphere_mesh(0.5, Isometry::Identity(), 24);
  Surface exact = matt(ball, Colour::Constant(0.7)), smooth = exact, facets = exact;
  smooth.normals = facets.normals = {};
  facets.smooth_normals = false;
  const Camera camera{Vec3(-3, 0.3, 2), Vec3::Zero(), Vec3::UnitZ(), 22.0};
  const auto difference = [&](const Surface& a, const Surface& b) {
    const Image one = render({&a, 1}, camera, small_picture()),
                other = render({&b, 1}, camera, small_picture());
    double sum = 0;
    for (std::size_t i = 0; i < one.rgb.size(); ++i) sum += std::abs(one.rgb[i] - other.rgb[i]);
    return sum / static_cast<double>(one.rgb.size());
  };
  EXPECT_LT(difference(exact, smooth), 0.2 * difference(exact, facets));
}

TriangleMesh folded_sheet(const Vec3& offset) {
  GridShape shape;
  shape.nu = shape.nv = 41;
  shape.origin = Vec3(-0.5, 0, 0.1);
  TriangleMesh mesh = make_grid(shape);
  for (Vec3& p : mesh.positions) p = p + Vec3(0, 0.08 * std::sin(25 * p.x()), 0) + offset;
  return mesh;
}

TEST(Render, FoldedClothHasNoBlackAndNoClipping) {
  const TriangleMesh mesh = folded_sheet(Vec3::Zero());
  const Surface cloth = surface_of(mesh);
  RenderOptions options = small_picture(320, 240);
  options.ground = 0.0;
  const Image image = render({&cloth, 1}, Camera{}, options);
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    EXPECT_GT(int{image.rgb[i]} + image.rgb[i + 1] + image.rgb[i + 2], 90);
    EXPECT_LT(std::max({image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]}), 254);
  }
}

TEST(Render, FarFromTheOriginThePictureIsTheSame) {
  const Vec3 far(3e6, -2e6, 1e6);
  const TriangleMesh here = folded_sheet(Vec3::Zero()), there = folded_sheet(far);
  const Surface cloth_here = surface_of(here), cloth_there = surface_of(there);
  Camera camera;
  RenderOptions options = small_picture();
  options.ground = 0.0;
  const Image one = render({&cloth_here, 1}, camera, options);
  camera.eye += far;
  camera.target += far;
  options.ground = far.z();
  const Image other = render({&cloth_there, 1}, camera, options);
  int differing = 0;
  for (std::size_t i = 0; i < one.rgb.size(); ++i)
    differing += std::abs(one.rgb[i] - other.rgb[i]) > 8 ? 1 : 0;
  EXPECT_LT(differing, static_cast<int>(one.rgb.size() / 500));
}

}  // namespace
}  // namespace taut
