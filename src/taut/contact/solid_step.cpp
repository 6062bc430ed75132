#include "taut/contact/solid_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {
namespace {

// A node on a ball may float by this share of the radius: it is outside, and the next step's plane
// takes it down again.
constexpr double floating_share = 2e-4;
// Cosine between normals beyond which two points count as on opposite sides: a path that only cuts
// a corner or a cap is no passage.
constexpr double other_side = -0.5;
constexpr double way_bound = 1.0 + 1e-6;  // covers rounding

double radius_about_origin(const Solid& solid) {
  switch (solid.shape) {
    case SolidShape::sphere:
      return solid.radius;
    case SolidShape::plane:
      return std::numeric_limits<double>::infinity();
    case SolidShape::cylinder:
      return std::hypot(solid.radius, 0.5 * solid.height);
    case SolidShape::box:
      return 0.5 * solid.size.norm();
    case SolidShape::mesh:
      return 0.0;
  }
  return std::numeric_limits<double>::infinity();
}

double characteristic_length(const Solid& solid) {
  switch (solid.shape) {
    case SolidShape::sphere:
    case SolidShape::cylinder:
      return solid.radius;
    case SolidShape::box:
      return 0.5 * solid.size.minCoeff();
    case SolidShape::plane:
    case SolidShape::mesh:
      return 0.0;
  }
  return 0.0;
}

}  // namespace

SolidStep::SolidStep(const Solid& solid, double t, double h)
    : solid_(&solid),
      bounding_radius_(radius_about_origin(solid) + solid.thickness),
      floating_tolerance_(floating_share * characteristic_length(solid)) {
  const Pose start = solid.pose(t), end = solid.pose(t + h);
  start_rotation_ = start.rotation.toRotationMatrix();
  end_rotation_ = end.rotation.toRotationMatrix();
  start_translation_ = start.translation;
  end_translation_ = end.translation;
  rotates_ = start_rotation_ != end_rotation_;
}

double SolidStep::share_inside(const Vec3& q0, const Vec3& q1, double depth) const {
  if (gap(q1) < depth) return 1.0;
  // Both ends are outside: the gap can only dip below in between if it falls at the start and rises
  // at the end. Bisect its slope.
  const Vec3 path = q1 - q0;
  const Vec3 start_normal = closest_surface(*solid_, q0).normal,
             end_normal = closest_surface(*solid_, q1).normal;
  if (start_normal.dot(end_normal) > other_side || start_normal.dot(path) >= 0.0 ||
      end_normal.dot(path) <= 0.0)
    return -1.0;
  double low = 0.0, high = 1.0;
  for (int k = 0; k < 48; ++k) {
    const double middle = 0.5 * (low + high);
    const SurfacePoint here = closest_surface(*solid_, q0 + middle * path);
    if (here.distance - solid_->thickness < depth) return middle;
    (here.normal.dot(path) < 0.0 ? low : high) = middle;
  }
  return -1.0;
}

bool SolidStep::meets(const Vec3& x0, const Vec3& x1, double largest_gap) const {
  const Vec3 to_end = x1 - end_translation_;
  const Vec3 relative = to_end - (x0 - start_translation_);
  // |x1 - c1| > reach + |relative motion|, by (a + b)² <= 2 a² + 2 b²: most nodes of a sheet leave
  // here without a square root.
  const double reach = bounding_radius_ + std::max(largest_gap, 0.0);
  if (to_end.squaredNorm() > 2.0 * (reach * reach + relative.squaredNorm())) return false;
  const Vec3 q1 = end_rotation_.transpose() * to_end;
  const double end = gap(q1);
  if (end <= largest_gap) return true;
  // A distance changes by no more than the way in the solid's frame: further out than that at the
  // end, the node was outside all the time.
  if (!rotates_ && end > 0.0 && end * end > way_bound * relative.squaredNorm()) return false;
  const Vec3 q0 = start_local(x0);
  if (rotates_ && end > 0.0 && end * end > way_bound * (q1 - q0).squaredNorm()) return false;
  return gap(q0) >= 0.0 && share_inside(q0, q1, -std::abs(largest_gap)) >= 0.0;
}

Vec3 SolidStep::onto_surface(const Vec3& local) const {
  const SurfacePoint nearest = closest_surface(*solid_, local);
  return local - (nearest.distance - solid_->thickness) * nearest.normal;
}

Vec3 SolidStep::anchor(const Vec3& x0, const Vec3& x1, double touch_tolerance) const {
  const Vec3 q0 = start_local(x0), q1 = end_local(x1);
  if (gap(q0) <= touch_tolerance) return onto_surface(q0);
  if (share_inside(q0, q1, 0.0) < 0.0) return onto_surface(q1);
  // Newton's method on a convex, falling function from the left never overshoots the first root.
  const Vec3 path = q1 - q0;
  double share = 0.0;
  for (int k = 0; k < 64; ++k) {
    const SurfacePoint here = closest_surface(*solid_, q0 + share * path);
    const double slope = here.normal.dot(path), left = here.distance - solid_->thickness;
    if (left <= 0.0 || slope >= 0.0) break;
    const double next = std::min(1.0, share - left / slope);
    if (next <= share) break;
    share = next;
  }
  return onto_surface(q0 + share * path);
}

LandingPlane SolidStep::landing(const Vec3& x1, const Vec3& anchor) const {
  const Vec3 q = end_local(x1);
  const SurfacePoint nearest = closest_surface(*solid_, q);
  const double nearest_gap = nearest.distance - solid_->thickness;
  const Vec3 entry_normal = closest_surface(*solid_, anchor).normal;
  const double least_agreement = nearest_gap < 0.0 ? 0.5 : other_side;
  if (nearest.normal.dot(entry_normal) < least_agreement)
    return {end_rotation_ * entry_normal, entry_normal.dot(q - anchor)};
  return {end_rotation_ * nearest.normal, nearest_gap};
}

}  // namespace taut
