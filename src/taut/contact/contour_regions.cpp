#include "taut/contact/contour_regions.h"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

Index root(std::vector<Index>& parent, Index k) {
  while (parent[k] != k) k = parent[k] = parent[parent[k]];
  return k;
}

std::vector<std::uint8_t> cut_edges(const CollisionSurface& surface,
                                    std::span<const Intersection> found) {
  std::vector<std::uint8_t> cut(surface.edges.size(), 0);
  for (const Intersection& at : found) cut[at.edge] ^= 1;
  return cut;
}

// Numbered by their least vertices.
std::vector<Index> joined_without(const CollisionSurface& surface,
                                  std::span<const std::uint8_t> cut, Index& count) {
  std::vector<Index> parent(static_cast<std::size_t>(surface.vertices)), region(parent.size());
  for (Index v = 0; v < surface.vertices; ++v) parent[v] = v;
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    if (cut[e]) continue;
    const Index a = root(parent, surface.edges[e][0]), b = root(parent, surface.edges[e][1]);
    parent[std::max(a, b)] = std::min(a, b);
  }
  count = 0;
  for (Index v = 0; v < surface.vertices; ++v)
    region[v] = root(parent, v) == v ? count++ : region[parent[v]];
  return region;
}

// Not 0 for regions that are not the largest of their body.
std::vector<std::uint8_t> spots(const CollisionSurface& surface, std::span<const Index> region,
                                Index count) {
  std::vector<Index> size(static_cast<std::size_t>(count), 0), body(size.size(), -1), largest;
  for (Index v = 0; v < surface.vertices; ++v) {
    ++size[region[v]];
    body[region[v]] = surface.body[v];
  }
  largest.resize(surface.body.empty() ? 0 : static_cast<std::size_t>(surface.body.back()) + 1, -1);
  for (Index r = 0; r < count; ++r)
    if (largest[body[r]] < 0 || size[r] > size[largest[body[r]]]) largest[body[r]] = r;
  std::vector<std::uint8_t> spot(size.size(), 0);
  for (Index r = 0; r < count; ++r) spot[r] = largest[body[r]] != r;
  return spot;
}

}  // namespace

ContourRegions contour_regions(const CollisionSurface& surface, std::span<const Intersection> found,
                               std::span<const ContourEnd> ends) {
  constexpr double clear = 0.3;  // mean of unit vectors; below that they contradict one another
  const std::vector<std::uint8_t> cut = cut_edges(surface, found);
  Index count = 0;
  ContourRegions regions{joined_without(surface, cut, count), {}};
  const std::vector<std::uint8_t> spot = spots(surface, regions.region, count);
  regions.way.assign(static_cast<std::size_t>(count), Vec3::Zero());
  std::vector<int> votes(regions.way.size(), 0);
  const auto vote = [&](Index r, const Vec3& way) {
    if (!spot[r]) return;
    regions.way[r] += way;
    ++votes[r];
  };
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!cut[found[k].edge]) continue;
    const auto& node = ends[k].node;
    const Index a = regions.region[node[0]], b = regions.region[node[1]];
    if (a == b) continue;
    const Vec3 from_a = ends[k].height > 0.0 ? Vec3(-ends[k].normal) : ends[k].normal;
    vote(a, from_a);
    vote(b, -from_a);
    const Vec3 back = spot[a] ? from_a : Vec3(-from_a);  // of the edge against the triangle
    if (!spot[a] && !spot[b]) continue;
    for (int c = 2; c < 5; ++c) vote(regions.region[node[c]], -back);
  }
  for (std::size_t r = 0; r < regions.way.size(); ++r) {
    const double length = regions.way[r].norm();
    regions.way[r] = votes[r] > 0 && length > clear * votes[r] ? Vec3(regions.way[r] / length)
                                                               : Vec3(Vec3::Zero());
  }
  return regions;
}

}  // namespace taut
