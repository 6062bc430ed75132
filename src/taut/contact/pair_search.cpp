#include "taut/contact/pair_search.h"

#include <algorithm>

#include "taut/base/parallel.h"

namespace taut {

namespace {

constexpr Index chunk = 2048;  // pairs handled by one task

// A plane across the line between the middles, that keeps all corners further apart than `distance`, settles most pairs cheaply.
bool surely_apart(const CollisionPair& pair, std::span<const Vec3> x, double distance) {
  const Vec3 &a = x[pair.node[0]], &b = x[pair.node[1]], &c = x[pair.node[2]], &d = x[pair.node[3]];
  if (pair.edges) {
    const Vec3 n = (a + b) - (c + d);
    return std::min(n.dot(a), n.dot(b)) - std::max(n.dot(c), n.dot(d)) > distance * n.norm();
  }
  const Vec3 n = 3.0 * a - (b + c + d);
  return n.dot(a) - std::max({n.dot(b), n.dot(c), n.dot(d)}) > distance * n.norm();
}

}  // namespace

template <class Pair>
void PairSearch::add_near(const std::vector<Pair>& pairs, std::span<const Vec3> x, double largest,
                          const std::function<double(const CollisionPair&)>& thickness, std::vector<NearPair>& near) {
  const Index count = static_cast<Index>(pairs.size()), chunks = (count + chunk - 1) / chunk;
  std::vector<std::vector<NearPair>> found(static_cast<std::size_t>(chunks));
  parallel_for(chunks, 1, [&](Index begin, Index end) {
    for (Index c = begin; c < end; ++c)
      for (Index k = c * chunk; k < std::min(count, (c + 1) * chunk); ++k) {
        const CollisionPair pair = pair_of(broad_phase_.surface(), pairs[k]);
        if (surely_apart(pair, x, largest)) continue;
        const NearPair candidate{pair, closest(pair, x)};
        if (candidate.proximity.inside && candidate.proximity.distance < thickness(candidate.pair)) found[c].push_back(candidate);
      }
  });
  for (const auto& part : found) near.insert(near.end(), part.begin(), part.end());
}

std::vector<NearPair> PairSearch::near(std::span<const Vec3> x0, std::span<const Vec3> x1, double largest,
                                       const std::function<double(const CollisionPair&)>& thickness) {
  broad_phase_.refit(x0, x1, largest);
  broad_phase_.find_vertex_triangle(vertex_triangle_);
  broad_phase_.find_edge_edge(edge_edge_);
  tested_ += std::ssize(vertex_triangle_) + std::ssize(edge_edge_);
  std::vector<NearPair> near;
  add_near(vertex_triangle_, x0, largest, thickness, near);
  add_near(edge_edge_, x0, largest, thickness, near);
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
