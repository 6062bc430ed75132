#include "taut/contact/broad_phase.h"

#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "taut/base/parallel.h"
#include "taut/contact/detection/box_tree.h"
#include "taut/contact/detection/tree_query.h"

namespace taut {

namespace {

using detail::Box;
using detail::BoxTree;
using detail::MovingBox;

// v rounded down: the double is made smaller by more than the conversion can make it larger.
float rounded_down(double v) { return static_cast<float>(v - std::abs(v) * 0x1p-23 - 1e-38); }
float rounded_up(double v) { return -rounded_down(-v); }

Box box_around(const Vec3& x, double half_margin) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Box box{{-infinity, -infinity, -infinity, 0}, {infinity, infinity, infinity, 0}};
  if (!x.allFinite()) return box;
  for (int i = 0; i < 3; ++i) {
    box.low[i] = rounded_down(x[i] - half_margin);
    box.high[i] = rounded_up(x[i] + half_margin);
  }
  return box;
}

template <class List>
std::vector<Index> flattened(const List& list) {
  std::vector<Index> corners;
  corners.reserve(list.size() * std::tuple_size_v<typename List::value_type>);
  for (const auto& item : list) corners.insert(corners.end(), item.begin(), item.end());
  return corners;
}

std::vector<Index> all_vertices(const CollisionSurface& surface) {
  std::vector<Index> corners(static_cast<std::size_t>(surface.vertices));
  for (Index v = 0; v < surface.vertices; ++v) corners[v] = v;
  return corners;
}

}  // namespace

struct BroadPhase::Trees {
  std::vector<MovingBox> boxes;  // of vertices
  BoxTree vertices, edges, triangles;

  Trees(const CollisionSurface& surface, std::span<const Vec3> positions)
      : boxes(static_cast<std::size_t>(surface.vertices)),
        vertices(all_vertices(surface), 1, positions, surface.is_solid),
        edges(flattened(surface.edges), 2, positions, surface.is_solid),
        triangles(flattened(surface.triangles), 3, positions, surface.is_solid) {}
};

BroadPhase::BroadPhase(const CollisionSurface& surface, std::span<const Vec3> positions)
    : surface_(&surface), trees_(std::make_unique<Trees>(surface, positions)) {}
BroadPhase::~BroadPhase() = default;
BroadPhase::BroadPhase(BroadPhase&&) noexcept = default;
BroadPhase& BroadPhase::operator=(BroadPhase&&) noexcept = default;

void BroadPhase::refit(std::span<const Vec3> x0, std::span<const Vec3> x1, double margin) {
  Trees& trees = *trees_;
  const bool still = x0.data() == x1.data();
  parallel_for(surface_->vertices, 4096, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v) {
      trees.boxes[v].at[0] = box_around(x0[v], 0.5 * margin);
      if (!still) trees.boxes[v].at[1] = box_around(x1[v], 0.5 * margin);
    }
  });
  for (BoxTree* tree : {&trees.vertices, &trees.edges, &trees.triangles})
    tree->refit(trees.boxes, still);
}

void BroadPhase::refit_moved(std::span<const Vec3> x0, std::span<const Vec3> x1, double margin,
                             std::span<const std::uint8_t> moved) {
  Trees& trees = *trees_;
  assert(x0.data() != x1.data());
  if (trees.vertices.still()) return refit(x0, x1, margin);
  for (Index v = 0; v < surface_->vertices; ++v)
    if (moved[v])
      trees.boxes[v] = {{box_around(x0[v], 0.5 * margin), box_around(x1[v], 0.5 * margin)}};
  for (BoxTree* tree : {&trees.vertices, &trees.edges, &trees.triangles})
    tree->refit_moved(trees.boxes, moved);
}

Index BroadPhase::vertex_parts() const { return detail::parts_of(trees_->vertices); }
Index BroadPhase::edge_parts() const { return detail::parts_of(trees_->edges); }

void BroadPhase::for_vertex_triangle(const UsePart<VertexTriangle>& use,
                                     std::span<const std::uint8_t> moved) const {
  const auto pair = [](Index vertex, Index triangle) { return VertexTriangle{vertex, triangle}; };
  detail::query<1, 3, VertexTriangle>(trees_->vertices, trees_->triangles, moved, pair, use);
}

void BroadPhase::for_edge_edge(const UsePart<EdgeEdge>& use,
                               std::span<const std::uint8_t> moved) const {
  const auto pair = [](Index a, Index b) { return EdgeEdge{std::min(a, b), std::max(a, b)}; };
  detail::query<2, 2, EdgeEdge>(trees_->edges, trees_->edges, moved, pair, use);
}

void BroadPhase::for_edge_triangle(const UsePart<EdgeTriangle>& use,
                                   std::span<const std::uint8_t> moved) const {
  const auto pair = [](Index edge, Index triangle) { return EdgeTriangle{edge, triangle}; };
  detail::query<2, 3, EdgeTriangle>(trees_->edges, trees_->triangles, moved, pair, use);
}

namespace {

// The list that for_pairs(use) gives in parts.
template <class Pair, class ForPairs>
void join(Index parts, const ForPairs& for_pairs, std::vector<Pair>& pairs) {
  std::vector<std::vector<Pair>> found(static_cast<std::size_t>(parts));
  for_pairs([&](Index part, std::span<const Pair> of_part) {
    found[static_cast<std::size_t>(part)].assign(of_part.begin(), of_part.end());
  });
  pairs.clear();
  for (const auto& list : found) pairs.insert(pairs.end(), list.begin(), list.end());
}

}  // namespace

void BroadPhase::find_vertex_triangle(std::vector<VertexTriangle>& pairs,
                                      std::span<const std::uint8_t> moved) const {
  join(
      vertex_parts(), [&](const UsePart<VertexTriangle>& use) { for_vertex_triangle(use, moved); },
      pairs);
}

void BroadPhase::find_edge_edge(std::vector<EdgeEdge>& pairs,
                                std::span<const std::uint8_t> moved) const {
  join(edge_parts(), [&](const UsePart<EdgeEdge>& use) { for_edge_edge(use, moved); }, pairs);
}

void BroadPhase::find_edge_triangle(std::vector<EdgeTriangle>& pairs,
                                    std::span<const std::uint8_t> moved) const {
  join(
      edge_parts(), [&](const UsePart<EdgeTriangle>& use) { for_edge_triangle(use, moved); },
      pairs);
}

}  // namespace taut
