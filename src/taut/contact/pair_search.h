#pragma once
// Which pairs are close at the start of a step, and which collide on the way: the broad
// phase, then closest points or continuous detection. All results in a fixed order, the same
// for any number of threads.
//
// One search serves a whole step. near() keeps the pairs that come within `reach` of each
// other on the way to x1, the candidates: those of the broad phase that no plane keeps
// apart (detection/clear_pairs.h). The response then changes the end of the way. Where
// each node's end is within
//
//   slack = (reach - separation)/2
//
// of where it was, two points are nearer than before by 2 slack at most, so that whatever comes
// within `separation` is still a candidate. Pairs of nodes that went further are looked for anew.
// In between, the broad phase must not be used for anything else but shapes at rest.

#include <functional>

#include "taut/contact/collision_pair.h"
#include "taut/contact/detection/clear_pairs.h"

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
  PairSearch(const CollisionSurface& surface, std::span<const Vec3> start)
      : broad_phase_(surface, start) {}

  // Begins the search of a step from x0 to x1. Returns the pairs closer at x0 than
  // thickness(pair) <= reach (m). reach > 0.
  std::vector<NearPair> near(std::span<const Vec3> x0, std::span<const Vec3> x1, double reach,
                             const std::function<double(const CollisionPair&)>& thickness);

  // Pairs with a vertex in `moved` (all, where it is empty) that come nearer than `separation` <
  // reach between x0, that of near(), and x1; for pairs that start nearer than that, nearer than
  // `kept_share` of where they start. Pairs for which skip() holds are left out.
  std::vector<CollidingPair> colliding(std::span<const Vec3> x0, std::span<const Vec3> x1,
                                       double separation, std::span<const std::uint8_t> moved,
                                       const std::function<bool(const CollisionPair&)>& skip);

  BroadPhase& broad_phase() { return broad_phase_; }
  // pairs of the broad phase, and candidates tested for collisions, so far
  Offset tested() const { return tested_; }
  void reset_count() { tested_ = 0; }

  static constexpr double kept_share = 0.8;

 private:
  using Corners = std::array<Index, 4>;  // of a pair, as in CollisionPair
  struct Candidates {
    std::vector<Corners> pairs;
    bool edges = false;
  };
  void add_candidates(std::span<const Vec3> x0, std::span<const std::uint8_t> moved,
                      std::vector<CollisionPair>* close);
  struct Part;
  template <class Pair>
  void keep(std::span<const Pair> pairs, bool edges, bool close, Part& part) const;
  void add(std::span<const Part> parts, Candidates& candidates, std::vector<CollisionPair>* close);
  void follow(std::span<const Vec3> x0, std::span<const Vec3> x1, double separation);
  void add_colliding(const Candidates& candidates, std::span<const Vec3> x0,
                     std::span<const Vec3> x1, double separation,
                     std::span<const std::uint8_t> moved,
                     const std::function<bool(const CollisionPair&)>& skip,
                     std::vector<CollidingPair>& colliding);

  BroadPhase broad_phase_;
  double reach_ = 0.0;
  std::vector<Vec3> end_;   // the candidates' x1
  detail::FloatWays ways_;  // from x0 to end_
  Candidates triangles_, edges_{{}, true};
  std::vector<std::uint8_t> far_;  // nodes whose end is further away from that than slack
  // Kept for their memory.
  std::vector<Corners> picked_;
  std::vector<PairImpact> impacts_;
  Offset tested_ = 0;
};

}  // namespace taut
