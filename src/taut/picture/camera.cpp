#include "taut/picture/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "taut/base/error.h"

namespace taut {

namespace {

constexpr double smallest_extent = 1e-6;   // m; anything smaller is drawn as a point
constexpr double extent_of_a_point = 1.0;  // m

double tangent_of_half(double degrees) { return std::tan(degrees * std::numbers::pi / 360.0); }

void check_field_of_view(double degrees) {
  if (!(degrees > 0.0 && degrees < 180.0))
    throw InputError(
        fmt::format("camera: field of view {} degrees, expected between 0 and 180", degrees));
}

void check_options(const FramingOptions& options) {
  check_field_of_view(options.vertical_field_of_view_deg);
  if (!options.direction.allFinite() || options.direction.isZero())
    throw InputError("camera: the view direction must be finite and not zero");
  if (!(options.aspect > 0.0) || !std::isfinite(options.aspect))
    throw InputError(
        fmt::format("camera: aspect {}, expected width / height above 0", options.aspect));
  if (!(options.margin >= 0.0 && options.margin <= 0.45))
    throw InputError(fmt::format(
        "camera: margin {}, expected a share of the picture from 0 to 0.45", options.margin));
}

// Along one axis of the picture: the two sides of the view wedge that touch the points.
struct Wedge {
  double tangent;
  double high = -std::numeric_limits<double>::infinity();
  double low = -std::numeric_limits<double>::infinity();
  void add(double across, double forward) {
    high = std::max(high, across - tangent * forward);
    low = std::max(low, -across - tangent * forward);
  }
  double closest() const { return -(high + low) / (2.0 * tangent); }
  double centre() const { return 0.5 * (high - low); }
};

}  // namespace

CameraAxes camera_axes(const Camera& camera) {
  if (!camera.eye.allFinite() || !camera.target.allFinite() || !camera.up.allFinite())
    throw InputError("camera: eye, target and up must be finite");
  check_field_of_view(camera.vertical_field_of_view_deg);
  CameraAxes axes;
  axes.forward = camera.target - camera.eye;
  if (!(axes.forward.norm() > 0.0))
    throw InputError("camera: eye and target are the same point, expected two different ones");
  axes.forward.normalize();
  axes.right = axes.forward.cross(camera.up.stableNormalized());
  if (axes.right.norm() < 1e-6)
    axes.right =
        axes.forward.cross(std::abs(axes.forward.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitX());
  axes.right.normalize();
  axes.up = axes.right.cross(axes.forward);
  return axes;
}

Projection project(const Camera& camera, const Vec3& point, int width, int height) {
  const CameraAxes axes = camera_axes(camera);
  const Vec3 d = point - camera.eye;
  const double depth = axes.forward.dot(d);
  const double pixels = 0.5 * height / (tangent_of_half(camera.vertical_field_of_view_deg) * depth);
  return {0.5 * width + pixels * axes.right.dot(d), 0.5 * height - pixels * axes.up.dot(d), depth};
}

Camera frame_camera(std::span<const Vec3> points, const FramingOptions& options) {
  check_options(options);
  if (points.empty()) throw InputError("camera: there is nothing to frame");
  BoundingBox box;
  for (const Vec3& p : points) {
    if (!p.allFinite())
      throw InputError(fmt::format("camera: a point to frame is ({}, {}, {}), expected finite",
                                   p.x(), p.y(), p.z()));
    box.extend(p);
  }
  if (box.diagonal().norm() < smallest_extent) {
    const Vec3 half = Vec3::Constant(0.5 * extent_of_a_point);
    return frame_camera(BoundingBox(box.center() - half, box.center() + half), options);
  }

  const CameraAxes axes = camera_axes(
      {options.direction, Vec3::Zero(), Vec3::UnitZ(), options.vertical_field_of_view_deg});
  const double inner = 1.0 - 2.0 * options.margin;
  const double tangent = tangent_of_half(options.vertical_field_of_view_deg) * inner;
  Wedge across{tangent * options.aspect}, upright{tangent};
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& p : points) {
    const Vec3 d = p - box.center();
    across.add(axes.right.dot(d), axes.forward.dot(d));
    upright.add(axes.up.dot(d), axes.forward.dot(d));
    nearest = std::min(nearest, axes.forward.dot(d));
  }
  // Points seen exactly end-on would let the eye touch them: stay a little in front of the nearest.
  const double forward =
      std::min({across.closest(), upright.closest(), nearest - 1e-2 * box.diagonal().norm()});
  Camera camera;
  camera.vertical_field_of_view_deg = options.vertical_field_of_view_deg;
  camera.eye = box.center() + across.centre() * axes.right + upright.centre() * axes.up +
               forward * axes.forward;
  camera.target = camera.eye - forward * axes.forward;
  return camera;
}

Camera frame_camera(const BoundingBox& box, const FramingOptions& options) {
  if (box.isEmpty())
    throw InputError("camera: the bounding box is empty, there is nothing to frame");
  std::array<Vec3, 8> corners;
  for (int c = 0; c < 8; ++c)
    corners[static_cast<std::size_t>(c)] = box.corner(static_cast<BoundingBox::CornerType>(c));
  return frame_camera(std::span<const Vec3>(corners), options);
}

}  // namespace taut
