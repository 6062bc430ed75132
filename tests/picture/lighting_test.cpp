#include "taut/picture/lighting.h"

#include <gtest/gtest.h>

#include "taut/picture/solid_mesh.h"

namespace taut::detail {
namespace {

// The light that a level point at the origin gives back without the key light, mean over 32 x 32
// pixels of 16 samples.
double light_of_the_sky(std::span<const Surface> surfaces) {
  const RayScene scene(surfaces, Vec3::Zero());
  Lights lights;
  lights.key = -Vec3f::UnitZ();
  make_frame(lights.key, lights.key_x, lights.key_y);
  lights.offset = 1e-5F;
  ShadePoint point;
  point.position.setZero();
  point.normal = point.facing = Vec3f::UnitZ();
  point.colour = Vec3f::Constant(0.5F);
  Packet<ShadePoint> points;
  points.fill(point);
  Packet<bool> active;
  active.fill(true);
  Packet<Vec3f> view, colours;
  view.fill(-Vec3f::UnitZ());
  double sum = 0.0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      for (const std::uint32_t first : {0U, 8U}) {
        const PixelPattern pattern(x, y, 16);
        Packet<PixelSample> samples;
        for (std::uint32_t i = 0; i < packet_size; ++i) samples[i] = {&pattern, first + i};
        light_points(scene, lights, samples, points, active, view, colours);
        for (const Vec3f& c : colours) sum += c.mean();
      }
  return sum / (32 * 32 * 16);
}

Isometry at_height(double z) {
  Isometry pose = Isometry::Identity();
  pose.translation().z() = z;
  return pose;
}

// The share of the sky, weighted by the cosine, that a sphere of radius r covers from a distance h
// right below it is (r/h)².
TEST(Lighting, AmbientOcclusionUnderASphereIsTheFormFactor) {
  const SolidMesh ceiling = make_quad_mesh(1e4, 1e4, at_height(0.5));
  const Surface ceiling_surface = solid_surface(ceiling);
  const double open = light_of_the_sky({}), closed = light_of_the_sky({&ceiling_surface, 1});
  EXPECT_GT(open, 1.5 * closed);
  for (const double radius : {0.2, 0.3, 0.5}) {
    const SolidMesh ball = make_sphere_mesh(radius, at_height(0.6));
    const Surface surface = solid_surface(ball);
    const double covered = (open - light_of_the_sky({&surface, 1})) / (open - closed);
    // the sky is 3 % darker overhead
    EXPECT_NEAR(covered / (radius * radius / 0.36), 1.0, 0.03) << "radius " << radius;
  }
}

}  // namespace
}  // namespace taut::detail
