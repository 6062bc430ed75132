#pragma once
// Which pairs are close at the start of a step, and which collide on the way: the broad phase, then closest points or continuous detection.
// All results in a fixed order, the same for any number of threads.

#include <functional>

#include "taut/contact/collision_pair.h"

namespace taut {

struct NearPair {
  CollisionPair pair;
  PairProximity proximity;
};

struct CollidingPair {
  CollisionPair pair;
  double time = 0.0;        // a lower bound, no unit
  double separation = 0.0;  // m: what was to be kept
};

class PairSearch {
 public:
  PairSearch(const CollisionSurface& surface, std::span<const Vec3> start) : broad_phase_(surface, start) {}

  // Pairs closer than thickness(pair) <= largest (m) at x0. The broad phase is made for the whole way to x1, and what a plane keeps further
  // apart than `largest` throughout is left out.
  std::vector<NearPair> near(std::span<const Vec3> x0, std::span<const Vec3> x1, double largest,
                             const std::function<double(const CollisionPair&)>& thickness);

  // Pairs with a vertex in `moved` (all, where it is empty) that come nearer than `separation` between x0 and x1; for pairs that start
  // nearer than that, nearer than `kept_share` of where they start. Pairs for which skip() holds are left out.
  std::vector<CollidingPair> colliding(std::span<const Vec3> x0, std::span<const Vec3> x1, double separation,
                                       std::span<const std::uint8_t> moved, const std::function<bool(const CollisionPair&)>& skip);

  // All colliding pairs, among those of the broad phase of near(), which must have been called for the same x0 and x1, with largest >=
  // separation.
  std::vector<CollidingPair> colliding_on_the_same_way(std::span<const Vec3> x0, std::span<const Vec3> x1, double separation,
                                                       const std::function<bool(const CollisionPair&)>& skip);

  BroadPhase& broad_phase() { return broad_phase_; }
  Offset tested() const { return tested_; }  // pairs of the broad phase so far
  void reset_count() { tested_ = 0; }

  static constexpr double kept_share = 0.8;

 private:
  template <class Pair>
  void add_near(std::vector<Pair>& pairs, std::span<const Vec3> x0, std::span<const Vec3> x1, double largest,
                const std::function<double(const CollisionPair&)>& thickness, std::vector<NearPair>& near);
  template <class Pair>
  void add_colliding(const std::vector<Pair>& pairs, std::span<const Vec3> x0, std::span<const Vec3> x1, double separation,
                     const std::function<bool(const CollisionPair&)>& skip, std::vector<CollidingPair>& colliding);

  BroadPhase broad_phase_;
  std::vector<VertexTriangle> vertex_triangle_;
  std::vector<EdgeEdge> edge_edge_;
  std::vector<PairImpact> impacts_;
  Offset tested_ = 0;
};

}  // namespace taut
