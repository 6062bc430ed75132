#pragma once
// One solid over one time step: where its surface is at both ends, whether a node meets it on the
// way, and the plane on which a node may land. All shapes are convex, so the signed distance along
// a straight path is a convex function, which makes entry points easy to find.
//
//   gap            signed distance minus the solid's thickness, m: negative inside
//   start, end     poses at t and t + h; a node's path is taken as straight in the solid's own
//                  frame from start^-1 x0 to end^-1 x1
//   anchor         local point on the thickened surface where the node touches first (or is
//                  already): a node that sticks ends there
//
// A node that lands on the tangent plane of a convex shape is never inside it.

#include "taut/contact/solid.h"

namespace taut {

// The plane n·y = n·e - gap of world points y, near the point e that it was
// made for. n has length 1.
struct LandingPlane {
  Vec3 normal = Vec3::UnitZ();
  double gap = 0.0;
};

class SolidStep {
 public:
  SolidStep(const Solid& solid, double t, double h);

  // Does a node that moves from x0 (at t) to x1 (at t + h) end with a gap of at most `largest_gap`,
  // or pass right through (out on the other side: normals more than 120 degrees apart; a path that
  // cuts a corner does not count)?
  bool meets(const Vec3& x0, const Vec3& x1, double largest_gap) const;
  double start_gap(const Vec3& x) const { return gap(start_local(x)); }
  double end_gap(const Vec3& x) const { return gap(end_local(x)); }
  // First touch of that path. A start gap within `touch_tolerance` counts as
  // touching from the start.
  Vec3 anchor(const Vec3& x0, const Vec3& x1, double touch_tolerance) const;
  // Where the solid's motion takes a local point by t + h.
  Vec3 carried(const Vec3& local) const { return end_rotation_ * local + end_translation_; }
  // The same for a world point at the start.
  Vec3 carried_from(const Vec3& x0) const { return carried(start_local(x0)); }
  // Tangent plane at the surface point nearest to x1 at the end; where x1 has gone so
  // deep (or through) that this would be a face on another side than the anchor's, the
  // tangent plane at the anchor.
  LandingPlane landing(const Vec3& x1, const Vec3& anchor) const;
  // Outward world normal at the end pose of a point on the surface.
  Vec3 end_normal(const Vec3& local) const {
    return end_rotation_ * closest_surface(*solid_, local).normal;
  }

  // m: how far a node may float over a curved surface before its landing plane must be made anew.
  double floating_tolerance() const { return floating_tolerance_; }
  double friction() const { return solid_->friction; }

 private:
  Vec3 start_local(const Vec3& x) const {
    return start_rotation_.transpose() * (x - start_translation_);
  }
  Vec3 end_local(const Vec3& x) const { return end_rotation_.transpose() * (x - end_translation_); }
  double gap(const Vec3& local) const {
    return surface_distance(*solid_, local) - solid_->thickness;
  }
  Vec3 onto_surface(const Vec3& local) const;
  // Some share of the path q0 -> q1 whose gap is below `depth`, or a negative
  // number when there is none.
  double share_inside(const Vec3& q0, const Vec3& q1, double depth) const;

  const Solid* solid_;
  Mat3 start_rotation_, end_rotation_;
  Vec3 start_translation_, end_translation_;
  double bounding_radius_;  // of the thickened solid about its origin; infinite for a plane
  double floating_tolerance_;
  bool rotates_ = false;
};

}  // namespace taut
