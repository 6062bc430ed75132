#include "taut/contact/pair_search.h"

#include <algorithm>

#include "taut/base/parallel.h"

namespace taut {

namespace {

constexpr Index chunk = 2048;  // pairs handled by one task

// The plane across the line between the middles at x0: does it keep all corners further apart than `distance` at x0, and at x1 too? What is
// linear in between is then clear on the whole way, by far more than rounding.
struct Clearance {
  bool at_start = false, throughout = false;
};

Clearance clearance(const CollisionPair& pair, std::span<const Vec3> x0, std::span<const Vec3> x1, double distance) {
  const auto& k = pair.node;
  const Vec3 n = pair.edges ? Vec3((x0[k[0]] + x0[k[1]]) - (x0[k[2]] + x0[k[3]])) : Vec3(3.0 * x0[k[0]] - (x0[k[1]] + x0[k[2]] + x0[k[3]]));
  const double least = distance * n.norm();
  const auto separates = [&](std::span<const Vec3> x) {
    // Relative to the first corner: the error is then one of the pair's size, not of its place.
    const Vec3& a = x[k[0]];
    const double b = n.dot(x[k[1]] - a), c = n.dot(x[k[2]] - a), d = n.dot(x[k[3]] - a);
    return (pair.edges ? std::min(0.0, b) - std::max(c, d) : -std::max({b, c, d})) > least;
  };
  if (!separates(x0)) return {};
  return {true, separates(x1)};
}

}  // namespace

template <class Pair>
void PairSearch::add_near(std::vector<Pair>& pairs, std::span<const Vec3> x0, std::span<const Vec3> x1, double largest,
                          const std::function<double(const CollisionPair&)>& thickness, std::vector<NearPair>& near) {
  const Index count = static_cast<Index>(pairs.size()), chunks = (count + chunk - 1) / chunk;
  std::vector<std::vector<NearPair>> found(static_cast<std::size_t>(chunks));
  std::vector<std::vector<Pair>> kept(static_cast<std::size_t>(chunks));
  parallel_for(chunks, 1, [&](Index begin, Index end) {
    for (Index c = begin; c < end; ++c)
      for (Index k = c * chunk; k < std::min(count, (c + 1) * chunk); ++k) {
        const CollisionPair pair = pair_of(broad_phase_.surface(), pairs[k]);
        const Clearance clear = clearance(pair, x0, x1, largest);
        if (clear.throughout) continue;
        kept[c].push_back(pairs[k]);
        if (clear.at_start) continue;
        const NearPair candidate{pair, closest(pair, x0)};
        if (candidate.proximity.inside && candidate.proximity.distance < thickness(candidate.pair)) found[c].push_back(candidate);
      }
  });
  pairs.clear();
  for (const auto& part : kept) pairs.insert(pairs.end(), part.begin(), part.end());
  for (const auto& part : found) near.insert(near.end(), part.begin(), part.end());
}

std::vector<NearPair> PairSearch::near(std::span<const Vec3> x0, std::span<const Vec3> x1, double largest,
                                       const std::function<double(const CollisionPair&)>& thickness) {
  broad_phase_.refit(x0, x1, largest);
  broad_phase_.find_vertex_triangle(vertex_triangle_);
  broad_phase_.find_edge_edge(edge_edge_);
  tested_ += std::ssize(vertex_triangle_) + std::ssize(edge_edge_);
  std::vector<NearPair> near;
  add_near(vertex_triangle_, x0, x1, largest, thickness, near);
  add_near(edge_edge_, x0, x1, largest, thickness, near);
  return near;
}

template <class Pair>
void PairSearch::add_colliding(const std::vector<Pair>& pairs, std::span<const Vec3> x0, std::span<const Vec3> x1, double separation,
                               const std::function<bool(const CollisionPair&)>& skip, std::vector<CollidingPair>& colliding) {
  CcdOptions options;
  options.minimum_separation = separation;
  find_impacts(broad_phase_.surface(), x0, x1, pairs, options, impacts_);
  for (const PairImpact& found : impacts_) {
    const CollisionPair pair = pair_of(broad_phase_.surface(), pairs[found.pair]);
    if (skip && skip(pair)) continue;
    CollidingPair hit{pair, found.time, separation};
    const double start = kept_share * closest(pair, x0).distance;
    if (start == 0.0) continue;  // they meet already, which the scene allows
    if (start < separation) {
      CcdOptions closer = options;
      closer.minimum_separation = hit.separation = start;
      closer.tolerance = std::min(options.tolerance, 0.01 * start);
      const Impact again = impact(pair, x0, x1, closer);
      if (!again.hit) continue;
      hit.time = again.time;
    }
    colliding.push_back(hit);
  }
}

std::vector<CollidingPair> PairSearch::colliding(std::span<const Vec3> x0, std::span<const Vec3> x1, double separation,
                                                 std::span<const std::uint8_t> moved,
                                                 const std::function<bool(const CollisionPair&)>& skip) {
  broad_phase_.refit(x0, x1, separation);
  broad_phase_.find_vertex_triangle(vertex_triangle_, moved);
  broad_phase_.find_edge_edge(edge_edge_, moved);
  tested_ += std::ssize(vertex_triangle_) + std::ssize(edge_edge_);
  return colliding_on_the_same_way(x0, x1, separation, skip);
}

std::vector<CollidingPair> PairSearch::colliding_on_the_same_way(std::span<const Vec3> x0, std::span<const Vec3> x1, double separation,
                                                                 const std::function<bool(const CollisionPair&)>& skip) {
  std::vector<CollidingPair> colliding;
  add_colliding(vertex_triangle_, x0, x1, separation, skip, colliding);
  add_colliding(edge_edge_, x0, x1, separation, skip, colliding);
  return colliding;
}

}  // namespace taut
