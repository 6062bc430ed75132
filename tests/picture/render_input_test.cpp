// What render does with thread counts, and with input that is empty, flat or wrong.
#include <gtest/gtest.h>

#include <limits>

#include "picture/picture_probe.h"
#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/mesh/grid.h"
#include "taut/picture/solid_mesh.h"

namespace taut {
namespace {

using test::small_picture;

TEST(RenderDeterminism, SameBitsForOneTwoAndFiveThreads) {
  GridShape shape;
  shape.nu = shape.nv = 61;
  shape.origin = Vec3(-0.5, 0, 0.1);
  TriangleMesh mesh = make_grid(shape);
  for (Vec3& p : mesh.positions) p.y() += 0.05 * std::sin(30 * p.x() + 7 * p.z());
  Surface cloth = surface_of(mesh);
  cloth.pattern = Pattern::grid;
  cloth.smooth_normals = false;  // on a common edge the choice of triangle shows
  const SolidMesh ball = make_sphere_mesh(0.2);
  const std::vector<Surface> surfaces{cloth, solid_surface(ball)};
  RenderOptions options = small_picture(200, 150);
  options.ground = 0.0;
  const int before = thread_count();
  std::vector<Image> images;
  for (const int threads : {1, 2, 5, 2}) {
    set_thread_count(threads);
    images.push_back(render(surfaces, Camera{}, options));
  }
  set_thread_count(before);
  for (std::size_t i = 1; i < images.size(); ++i)
    EXPECT_EQ(images[0].rgb, images[i].rgb) << "picture " << i;
}

TEST(RenderInput, NothingToDrawGivesTheBackground) {
  const Surface empty;
  const Image none = render({}, Camera{}, small_picture(20, 10)),
              one = render({&empty, 1}, Camera{}, small_picture(20, 10));
  EXPECT_EQ(none.rgb.size(), 600U);
  EXPECT_EQ(none.rgb, one.rgb);
  EXPECT_LT(none.pixel(3, 0)[0], none.pixel(3, 9)[0]);  // lighter downwards
}

TEST(RenderInput, TrianglesWithoutAreaDrawNothingAndSpoilNothing) {
  const SolidMesh ball = make_sphere_mesh(0.4);
  const Surface clean = solid_surface(ball);
  SolidMesh spoiled = ball;
  spoiled.mesh.triangles.push_back({5, 5, 5});
  spoiled.mesh.triangles.push_back({7, 8, 7});
  // on one line
  spoiled.mesh.positions.insert(spoiled.mesh.positions.end(),
                                {Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(1, 0, 2)});
  spoiled.normals.insert(spoiled.normals.end(), 3, Vec3::Zero());
  spoiled.mesh.texcoords.insert(spoiled.mesh.texcoords.end(), 3, Vec2::Zero());
  const auto last = static_cast<Index>(spoiled.mesh.positions.size());
  spoiled.mesh.triangles.push_back({last - 3, last - 2, last - 1});
  for (const bool smooth : {true, false}) {
    Surface a = clean, b = solid_surface(spoiled);
    a.normals = b.normals = {};
    a.smooth_normals = b.smooth_normals = smooth;
    EXPECT_EQ(render({&a, 1}, Camera{}, small_picture()).rgb,
              render({&b, 1}, Camera{}, small_picture()).rgb);
  }
}

// The message of the InputError that drawing this throws; empty if none.
std::string complaint(const Surface& surface, const Camera& camera = {},
                      const RenderOptions& options = small_picture(8, 8)) {
  try {
    render({&surface, 1}, camera, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RenderInput, BadSurfacesAreRefusedByNameAndPlace) {
  SolidMesh ball = make_sphere_mesh(0.4);
  const auto fresh = [&] {
    Surface surface = solid_surface(ball);
    surface.name = "ball";
    return surface;
  };
  EXPECT_EQ(complaint(fresh()), "");
  ball.mesh.positions[17].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(complaint(fresh()).find("surface 'ball': vertex 17 is at ("), std::string::npos)
      << complaint(fresh());
  ball.mesh.positions[17].y() = 1e200;
  EXPECT_NE(complaint(fresh()).find("vertex 17"), std::string::npos);
  ball.mesh.positions[17].y() = 0;
  for (const Index wrong : {-1, static_cast<Index>(ball.mesh.positions.size())}) {
    const Index right = std::exchange(ball.mesh.triangles[3][1], wrong);
    EXPECT_NE(complaint(fresh()).find("triangle 3 names vertex " + std::to_string(wrong)),
              std::string::npos)
        << complaint(fresh());
    ball.mesh.triangles[3][1] = right;
  }
  Surface surface = fresh();
  surface.pattern = Pattern::grid;
  EXPECT_EQ(complaint(surface), "");
  surface.texcoords = {};
  EXPECT_NE(complaint(surface).find("texture coordinates"), std::string::npos);
  surface = fresh();
  surface.normals = surface.normals.first(4);
  EXPECT_NE(complaint(surface).find("4 normals"), std::string::npos);
  surface = fresh();
  surface.front.x() = 1.5;
  EXPECT_NE(complaint(surface).find("colour"), std::string::npos);
}

TEST(RenderInput, BadCamerasAndOptionsAreRefused) {
  const Surface surface;
  Camera camera;
  camera.target = camera.eye;
  EXPECT_NE(complaint(surface, camera).find("same point"), std::string::npos);
  camera = Camera{};
  camera.vertical_field_of_view_deg = 180;
  EXPECT_NE(complaint(surface, camera).find("field of view"), std::string::npos);
  EXPECT_NE(complaint(surface, {}, small_picture(0, 8)).find("0 x 8"), std::string::npos);
  RenderOptions options = small_picture(8, 8);
  options.samples = 0;
  EXPECT_NE(complaint(surface, {}, options).find("samples"), std::string::npos);
  options = small_picture(8, 8);
  options.ground = std::numeric_limits<double>::infinity();
  EXPECT_NE(complaint(surface, {}, options).find("ground"), std::string::npos);
}

}  // namespace
}  // namespace taut
