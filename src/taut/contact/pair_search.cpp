#include "taut/contact/pair_search.h"

#include <algorithm>

#include "taut/base/collect.h"

namespace taut {

namespace {

constexpr Index chunk = 1024;                 // pairs handled by one task
constexpr double certain_share = 1.0 - 1e-9;  // of the slack

bool any_in(const std::array<Index, 4>& nodes, std::span<const std::uint8_t> marked) {
  return marked[nodes[0]] | marked[nodes[1]] | marked[nodes[2]] | marked[nodes[3]];
}

// picked: those pairs that have a marked node, or those that have none, in their order.
void pick_pairs(std::span<const std::array<Index, 4>> pairs, std::span<const std::uint8_t> marked,
                bool with, std::vector<std::array<Index, 4>>& picked) {
  picked.clear();
  const auto pick = [&](Index begin, Index end, std::vector<std::array<Index, 4>>& of_chunk) {
    std::ranges::copy_if(
        pairs.subspan(begin, end - begin), std::back_inserter(of_chunk),
        [&](const std::array<Index, 4>& nodes) { return any_in(nodes, marked) == with; });
  };
  collect(static_cast<Index>(pairs.size()), 16 * chunk, pick, picked);
}

}  // namespace

// Of a part of the broad phase's pairs: those that come within reach on the way to end_, and those
// that may be within it at the start.
struct PairSearch::Part {
  std::vector<Corners> kept;
  std::vector<CollisionPair> close;
  Offset tested = 0;
};

template <class Pair>
void PairSearch::keep(std::span<const Pair> pairs, bool edges, bool close, Part& part) const {
  std::array<Corners, chunk> corners{};
  std::array<std::uint8_t, chunk> clear{};
  part.tested = std::ssize(pairs);
  for (; !pairs.empty(); pairs = pairs.subspan(std::min<std::size_t>(chunk, pairs.size()))) {
    const Index count = std::min(chunk, static_cast<Index>(pairs.size()));
    for (Index k = 0; k < count; ++k) corners[k] = pair_of(broad_phase_.surface(), pairs[k]).node;
    ways_.find_clear(corners.data(), count, edges, reach_, clear.data());
    for (Index k = 0; k < count; ++k) {
      if (clear[k] & detail::clear_throughout) continue;
      part.kept.push_back(corners[k]);
      if (close && !(clear[k] & detail::clear_at_start)) part.close.push_back({corners[k], edges});
    }
  }
}

// Adds the candidates among the broad phase's pairs, and to `close` those that may be
// within reach at the start.
void PairSearch::add_candidates(std::span<const Vec3> x0, std::span<const std::uint8_t> moved,
                                std::vector<CollisionPair>* close) {
  if (moved.empty()) {
    broad_phase_.refit(x0, end_, reach_);
  } else {
    broad_phase_.refit_moved(x0, end_, reach_, moved);
  }
  ways_.set(x0, end_);
  std::vector<Part> parts(static_cast<std::size_t>(broad_phase_.vertex_parts()));
  broad_phase_.for_vertex_triangle(
      [&](Index part, std::span<const VertexTriangle> pairs) {
        keep(pairs, false, close != nullptr, parts[part]);
      },
      moved);
  add(parts, triangles_, close);
  parts.assign(static_cast<std::size_t>(broad_phase_.edge_parts()), {});
  broad_phase_.for_edge_edge(
      [&](Index part, std::span<const EdgeEdge> pairs) {
        keep(pairs, true, close != nullptr, parts[part]);
      },
      moved);
  add(parts, edges_, close);
}

void PairSearch::add(std::span<const Part> parts, Candidates& candidates,
                     std::vector<CollisionPair>* close) {
  for (const Part& part : parts) {
    candidates.pairs.insert(candidates.pairs.end(), part.kept.begin(), part.kept.end());
    if (close) close->insert(close->end(), part.close.begin(), part.close.end());
    tested_ += part.tested;
  }
}

std::vector<NearPair> PairSearch::near(
    std::span<const Vec3> x0, std::span<const Vec3> x1, double reach,
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
          if (candidate.proximity.inside &&
              candidate.proximity.distance < thickness(candidate.pair))
            found.push_back(candidate);
        }
      },
      near);
  return near;
}

// Sees to it that what comes within `separation` on the way to x1 is a candidate.
void PairSearch::follow(std::span<const Vec3> x0, std::span<const Vec3> x1, double separation) {
  const double slack = 0.5 * certain_share * (reach_ - separation);
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
  for (Candidates* candidates : {&triangles_, &edges_}) {
    pick_pairs(candidates->pairs, far_, false, picked_);
    std::swap(candidates->pairs, picked_);
  }
  add_candidates(x0, far_, nullptr);
}

void PairSearch::add_colliding(const Candidates& candidates, std::span<const Vec3> x0,
                               std::span<const Vec3> x1, double separation,
                               std::span<const std::uint8_t> moved,
                               const std::function<bool(const CollisionPair&)>& skip,
                               std::vector<CollidingPair>& colliding) {
  std::span<const Corners> pairs = candidates.pairs;
  if (!moved.empty()) {
    pick_pairs(pairs, moved, true, picked_);
    pairs = picked_;
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

std::vector<CollidingPair> PairSearch::colliding(
    std::span<const Vec3> x0, std::span<const Vec3> x1, double separation,
    std::span<const std::uint8_t> moved, const std::function<bool(const CollisionPair&)>& skip) {
  follow(x0, x1, separation);
  std::vector<CollidingPair> colliding;
  add_colliding(triangles_, x0, x1, separation, moved, skip, colliding);
  add_colliding(edges_, x0, x1, separation, moved, skip, colliding);
  return colliding;
}

}  // namespace taut
