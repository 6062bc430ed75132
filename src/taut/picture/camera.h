#pragma once
// A pinhole camera and its automatic framing.
//
//   image plane   pixel (x, y) of a width x height picture, (0, 0) the top left corner, y downwards
//   eye, target   m: where the camera is, and the point in the middle of the picture
//   up            no unit: the direction that points upwards in the picture, not along target - eye
//   fov           degrees: the full vertical angle of view
//
// Framing solves for the eye exactly. With the points' coordinates (r, u, f) along right, up and
// forward, and tx, ty the tangents of the half angles, a point is inside when
// |r - e_r| <= tx (f - e_f) and |u - e_u| <= ty (f - e_f); the largest e_f that all points allow is
// the closest camera, and e_r, e_u put the margins left/right and below/above equal.

#include <Eigen/Geometry>
#include <span>

#include "taut/base/types.h"

namespace taut {

struct Camera {
  Vec3 eye = Vec3(2, -4, 2);
  Vec3 target = Vec3::Zero();
  Vec3 up = Vec3::UnitZ();
  double vertical_field_of_view_deg = 30.0;
};

// Right, up and forward unit vectors of the picture, right-handed (right x up = -forward).
struct CameraAxes {
  Vec3 right, up, forward;
};

// Throws InputError when eye, target, up or the field of view are not finite, eye and target
// coincide, or the field of view is not in (0, 180) degrees. An `up` along the view is
// replaced by another axis.
CameraAxes camera_axes(const Camera& camera);

// Where a point falls in the picture, in pixels, and its depth (m) along forward; behind the camera
// when depth <= 0 (x and y then mean nothing).
struct Projection {
  double x = 0.0, y = 0.0, depth = 0.0;
};
Projection project(const Camera& camera, const Vec3& point, int width, int height);

using BoundingBox = Eigen::AlignedBox3d;  // empty by default; extend() with points or boxes

struct FramingOptions {
  // from the target to the eye, any length: a three-quarter view from the front, Z up
  Vec3 direction = Vec3(0.55, -1.0, 0.42);
  double aspect = 16.0 / 9.0;  // width / height of the picture
  // share of the picture kept free along each border, in [0, 0.45]
  double margin = 0.05;
  double vertical_field_of_view_deg = 28.0;
};

// The closest camera in the given direction that has the whole box (over all frames of a run)
// inside the margins. A box of no extent is framed as if 1 m wide. Throws InputError when the box
// is empty or not finite, or an option is out of range.
Camera frame_camera(const BoundingBox& box, const FramingOptions& options = {});

// The same for points: tighter than their box.
Camera frame_camera(std::span<const Vec3> points, const FramingOptions& options = {});

}  // namespace taut
