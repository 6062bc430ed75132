#include "taut/contact/pair_search.h"

#include <algorithm>

#include "taut/base/collect.h"

namespace taut {

namespace {

constexpr Index chunk = 1024;                  // pairs handled by one task
constexpr double rounding_share = 1.0 - 1e-9;  // of the slack

bool any_in(const std::array<Index, 4>& nodes, std::span<const std::uint8_t> marked) {
  return marked[nodes[0]] | marked[nodes[1]] | marked[nodes[2]] | marked[nodes[3]];
}

}  // namespace

// Adds those of the broad phase's pairs that come within reach on the way to end_, and to `close` those that may be within it at the start.
template <class Pair>
void PairSearch::keep_candidates(const std::vector<Pair>& pairs, Candidates& candidates, std::vector<CollisionPair>* close) {
  std::vector<CollisionPair> unasked;
  const auto keep = [&](Index begin, Index end, std::vector<Corners>& kept, std::vector<CollisionPair>& found) {
    std::array<Corners, chunk> corners{};
    std::array<std::uint8_t, chunk> clear;
    for (Index k = begin; k < end; ++k) corners[k - begin] = pair_of(broad_phase_.surface(), pairs[k]).node;
    ways_.find_clear(corners.data(), end - begin, candidates.edges, reach_, clear.data());
    for (Index k = 0; k < end - begin; ++k) {
      if (clear[k] & detail::clear_throughout) continue;
      kept.push_back(corners[k]);
      if (close && !(clear[k] & detail::clear_at_start)) found.push_back({corners[k], candidates.edges});
    }
  };
  collect(static_cast<Index>(pairs.size()), chunk, keep, candidates.pairs, close ? *close : unasked);
}

void PairSearch::add_candidates(std::span<const Vec3> x0, std::span<const std::uint8_t> moved, std::vector<CollisionPair>* close) {
  if (moved.empty()) {
    broad_phase_.refit(x0, end_, reach_);
  } else {
    broad_phase_.refit_moved(x0, end_, reach_, moved);
  }
  ways_.set(x0, end_);
  broad_phase_.find_vertex_triangle(vertex_triangle_, moved);
  broad_phase_.find_edge_edge(edge_edge_, moved);
  tested_ += std::ssize(vertex_triangle_) + std::ssize(edge_edge_);
  keep_candidates(vertex_triangle_, triangles_, close);
  keep_candidates(edge_edge_, edges_, close);
}

std::vector<NearPair> PairSearch::near(std::span<const Vec3> x0, std::span<const Vec3> x1, double reach,
                                       const std::function<double(const CollisionPair&)>& thickness) {
  reach_ = reach;
  end_.assign(x1.begin(), x1.end());
  triangles_.pairs.clear();
  edges_.pairs.clear();
  std::vector<CollisionPair> close;
  add_candidates(x0, {}, &close);
  std::vector<NearPair> near;
  collect(
      static_cast<Index>(close.size()), chunk,
      [&](Index begin, Index end, std::vector<NearPair>& found) {
        for (Index k = begin; k < end; ++k) {
          const NearPair candidate{close[k], closest(close[k], x0)};
          if (candidate.proximity.inside && candidate.proximity.distance < thickness(candidate.pair)) found.push_back(candidate);
        }
      },
      near);
  return near;
}

// Sees to it that what comes within `separation` on the way to x1 is a candidate.
void PairSearch::follow(std::span<const Vec3> x0, std::span<const Vec3> x1, double separation) {
  const double slack = 0.5 * rounding_share * (reach_ - separation);
  far_.assign(x1.size(), 0);
  bool any = false;
  for (std::size_t v = 0; v < x1.size(); ++v) {
    // What is not finite is far, too.
    if ((x1[v] - end_[v]).squaredNorm() <= slack * slack) continue;
    end_[v] = x1[v];
    far_[v] = 1;
    any = true;
  }
  if (!any) return;
  for (Candidates* candidates : {&triangles_, &edges_})
    std::erase_if(candidates->pairs, [&](const Corners& pair) { return any_in(pair, far_); });
  add_candidates(x0, far_, nullptr);
}

void PairSearch::add_colliding(const Candidates& candidates, std::span<const Vec3> x0, std::span<const Vec3> x1, double separation,
                               std::span<const std::uint8_t> moved, const std::function<bool(const CollisionPair&)>& skip,
                               std::vector<CollidingPair>& colliding) {
  std::span<const Corners> pairs = candidates.pairs;
  if (!moved.empty()) {
    with_moved_.clear();
    std::ranges::copy_if(pairs, std::back_inserter(with_moved_), [&](const Corners& pair) { return any_in(pair, moved); });
    pairs = with_moved_;
  }
  tested_ += std::ssize(pairs);
  CcdOptions options;
  options.minimum_separation = separation;
  find_impacts(pairs, candidates.edges, x0, x1, options, impacts_);
  for (const PairImpact& found : impacts_) {
    const CollisionPair pair{pairs[found.pair], candidates.edges};
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
  follow(x0, x1, separation);
  std::vector<CollidingPair> colliding;
  add_colliding(triangles_, x0, x1, separation, moved, skip, colliding);
  add_colliding(edges_, x0, x1, separation, moved, skip, colliding);
  return colliding;
}

}  // namespace taut
