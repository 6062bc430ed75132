#include "taut/picture/camera.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>

#include "taut/base/error.h"

namespace taut {
namespace {

struct Extent {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9, nearest = 1e9;
};

Extent seen_extent(const Camera& camera, const std::vector<Vec3>& points, int width, int height) {
  Extent e;
  for (const Vec3& p : points) {
    const Projection q = project(camera, p, width, height);
    e.left = std::min(e.left, q.x);
    e.right = std::max(e.right, q.x);
    e.top = std::min(e.top, q.y);
    e.bottom = std::max(e.bottom, q.y);
    e.nearest = std::min(e.nearest, q.depth);
  }
  return e;
}

std::vector<Vec3> corners(const BoundingBox& box) {
  std::vector<Vec3> points;
  for (int c = 0; c < 8; ++c) points.push_back(box.corner(static_cast<BoundingBox::CornerType>(c)));
  return points;
}

// Inside the margins, and no closer camera possible: two opposite borders are touched, or the eye
// would touch the nearest point.
void expect_framed(const Camera& camera, const std::vector<Vec3>& points, int width, int height,
                   double margin) {
  const Extent e = seen_extent(camera, points, width, height);
  const double mx = margin * width, my = margin * height, slack = 1e-6 * width;
  EXPECT_GT(e.nearest, 0.0);
  EXPECT_GE(e.left, mx - slack);
  EXPECT_LE(e.right, width - mx + slack);
  EXPECT_GE(e.top, my - slack);
  EXPECT_LE(e.bottom, height - my + slack);
  const bool full_width = e.left < mx + slack && e.right > width - mx - slack;
  const bool full_height = e.top < my + slack && e.bottom > height - my - slack;
  BoundingBox box;
  for (const Vec3& p : points) box.extend(p);
  const bool near = e.nearest < 0.011 * box.diagonal().norm();
  EXPECT_TRUE(full_width || full_height || near)
      << e.left << " " << e.right << " " << e.top << " " << e.bottom;
}

TEST(Camera, ProjectsByTheFieldOfView) {
  const Camera camera{Vec3(0, -2, 1), Vec3(0, 0, 1), Vec3::UnitZ(), 90.0};  // looks along +y
  const Projection middle = project(camera, Vec3(0, 3, 1), 400, 200);
  EXPECT_NEAR(middle.x, 200, 1e-9);
  EXPECT_NEAR(middle.y, 100, 1e-9);
  EXPECT_NEAR(middle.depth, 5, 1e-12);
  const Projection above_right = project(camera, Vec3(2, 0, 2), 400, 200);  // slopes 1 and 1/2
  EXPECT_NEAR(above_right.x, 300, 1e-9);
  EXPECT_NEAR(above_right.y, 50, 1e-9);
  EXPECT_LT(project(camera, Vec3(0, -3, 1), 400, 200).depth, 0.0);
}

TEST(Camera, LookingAlongUpStillHasAxes) {
  const CameraAxes axes = camera_axes({Vec3(0, 0, 5), Vec3::Zero(), Vec3::UnitZ(), 30.0});
  EXPECT_NEAR(axes.right.cross(axes.up).dot(-axes.forward), 1.0, 1e-12);
}

TEST(Framing, BoxesFillThePictureUpToTheMargin) {
  const std::vector<BoundingBox> boxes{
      // a flat sheet
      BoundingBox(Vec3(-0.5, -0.5, -0.5), Vec3(0.5, 0.5, 0.5)),
      BoundingBox(Vec3(-1, 0, -1), Vec3(1, 0, 1)),
      // a line
      BoundingBox(Vec3(0, 0, 0), Vec3(10, 0.01, 0.01)),
      BoundingBox(Vec3(0, 0, 0), Vec3(0, 0, 3)),
      // far away; tiny
      BoundingBox(Vec3(1e5, 1e5, 0), Vec3(1e5 + 1, 1e5 + 2, 3)),
      BoundingBox(Vec3::Zero(), Vec3::Constant(2e-3)),
  };
  for (const BoundingBox& box : boxes)
    for (const Vec3& direction :
         {FramingOptions{}.direction, Vec3(1, 0, 0), Vec3(-1, 2, 0.1), Vec3(0.3, -1, -0.8)})
      for (const auto& [width, height] :
           {std::pair{480, 360}, std::pair{1280, 720}, std::pair{300, 900}})
        for (const double margin : {0.0, 0.05, 0.3}) {
          FramingOptions options;
          options.direction = direction;
          options.aspect = static_cast<double>(width) / height;
          options.margin = margin;
          const Camera camera = frame_camera(box, options);
          expect_framed(camera, corners(box), width, height, margin);
          EXPECT_GT((camera.eye - camera.target).dot(direction), 0.0);
          EXPECT_LT((camera.eye - camera.target).cross(direction.normalized()).norm(),
                    1e-9 * (1 + camera.eye.norm()));
        }
}

TEST(Framing, PointsAreFramedTighterThanTheirBox) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  BoundingBox box;
  for (int i = 0; i < 400; ++i) {
    points.push_back(Vec3(normal(random), normal(random), normal(random)).normalized());
    box.extend(points.back());
  }
  FramingOptions options;
  options.aspect = 2.0;
  const Camera tight = frame_camera(std::span<const Vec3>(points), options);
  expect_framed(tight, points, 800, 400, options.margin);
  EXPECT_LT((tight.eye - tight.target).norm(),
            0.8 * (frame_camera(box, options).eye - box.center()).norm());
}

TEST(Framing, AFlatSheetSeenEdgeOnOrFromAboveIsInView) {
  const BoundingBox sheet(Vec3(-1, 0, -1), Vec3(1, 0, 1));
  FramingOptions options;
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    options.direction = direction;
    const Extent e = seen_extent(frame_camera(sheet, options), corners(sheet), 1600, 900);
    EXPECT_TRUE(e.nearest > 0 && e.left >= 79.99 && e.right <= 1520.01 && e.top >= 44.99 &&
                e.bottom <= 855.01);
  }
}

TEST(Framing, ASinglePointIsFramedAsOneMetre) {
  const Vec3 point(3, 4, 5);
  const Camera camera = frame_camera(BoundingBox(point));
  EXPECT_TRUE(camera.target.isApprox(point, 0.1));
  const double distance = (camera.eye - point).norm();
  EXPECT_GT(distance, 1.0);
  EXPECT_LT(distance, 10.0);
}

TEST(Framing, BadInputIsRefused) {
  const BoundingBox box(Vec3::Zero(), Vec3::Ones());
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(frame_camera(BoundingBox()), InputError);
  EXPECT_THROW(frame_camera(std::span<const Vec3>()), InputError);
  EXPECT_THROW(frame_camera(BoundingBox(Vec3::Zero(), Vec3(1, inf, 1))), InputError);
  const std::vector<Vec3> points{Vec3::Zero(), Vec3(nan, 0, 0)};
  EXPECT_THROW(frame_camera(std::span<const Vec3>(points)), InputError);
  FramingOptions options;
  options.direction = Vec3::Zero();
  EXPECT_THROW(frame_camera(box, options), InputError);
  options = {};
  options.margin = 0.5;
  EXPECT_THROW(frame_camera(box, options), InputError);
  options = {};
  options.aspect = 0;
  EXPECT_THROW(frame_camera(box, options), InputError);
}

}  // namespace
}  // namespace taut
