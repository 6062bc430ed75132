#pragma once
// Analytic solids over one step, as obstacles on the ways of nodes: which solid a node would end
// in, and the plane on which it may land. This is all that surface contact asks; ContactSet finds
// its contacts with it. Knows neither friction nor what happened before.
//
//   way              from the node's start to x_end, m, straight as the solid sees it
//                    (solid_step.h)
//   gap              distance from the solid's thickened surface, m; negative inside
//   touch tolerance  m: a gap up to it counts as touching
//   depth tolerance  m: how deep a node may end for now; the touch tolerance, or 2e-4 of the size
//                    of a solid that is no plane, whichever is larger
//
// begin_step first. It and set_motion are called by one thread, between steps; the questions are
// const and may be asked by many. docs/design/solid_contact.md

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "taut/contact/solid_step.h"

namespace taut {

// A solid in a node's way: the plane n·x = offset on which the node may end.
struct Obstacle {
  Index solid = 0;
  Vec3 normal = Vec3::UnitZ();
  double offset = 0.0;          // m
  Vec3 carried = Vec3::Zero();  // m: where the solid's motion takes the node's place at the start
  double friction = 0.0;
};

class SolidObstacles {
 public:
  // meets: one list a solid, of one byte a node: 1 where the node may touch it; an empty list, or
  // none at all: all nodes.
  SolidObstacles(std::vector<Solid> solids, Index nodes, double touch_tolerance,
                 std::vector<std::vector<std::uint8_t>> meets = {});

  // Solid k moves as this one from the next step on. Its shape is the same (asserted).
  void set_motion(std::size_t k, const Solid& solid);
  // Step [t, t + h], s, of nodes that are at `start`, m; copied.
  void begin_step(double t, double h, std::span<const Vec3> start);

  // The first solid in which the node would end deeper than the depth tolerance, or through which
  // it would pass; null if there is none.
  std::optional<Obstacle> obstacle(Index node, const Vec3& x_end) const;
  // The plane of one solid for a node that ends at x_end, wherever that is.
  Obstacle obstacle(Index node, Index solid, const Vec3& x_end) const;
  // Moves x_end out of every solid that is in the way, one after the other. Returns the greatest
  // depth, m, at least 0; null if none was in the way.
  std::optional<double> move_out(Index node, Vec3& x_end) const;

  Index nodes() const { return nodes_; }
  std::span<const Solid> solids() const { return solids_; }
  const SolidStep& step(Index solid) const { return steps_[static_cast<std::size_t>(solid)]; }
  const Vec3& start(Index node) const { return start_[node]; }
  bool may_meet(Index solid, Index node) const {
    const std::vector<std::uint8_t>& meets = meets_[static_cast<std::size_t>(solid)];
    return meets.empty() || meets[node];
  }
  double touch_tolerance() const { return touch_tolerance_; }
  double depth_tolerance(Index solid) const;

 private:
  bool in_the_way(Index node, Index solid, const Vec3& x_end) const;
  LandingPlane landing(Index node, Index solid, const Vec3& x_end) const;

  std::vector<Solid> solids_;
  Index nodes_;
  double touch_tolerance_;
  std::vector<std::vector<std::uint8_t>> meets_;
  std::vector<SolidStep> steps_;  // one a solid
  std::vector<Vec3> start_;       // m: x at t
};

}  // namespace taut
