#include "taut/contact/untangle_separate.h"

#include <algorithm>
#include <optional>

#include "taut/contact/contour_regions.h"

namespace taut {

namespace {

constexpr int length_iterations = 6;
// Gradients this small (no unit) get less than a whole step: a smooth contour's is its curvature,
// and its sign is noise.
constexpr double small_gradient = 0.3;

// What nodes are asked to do by several pairs: the mean.
struct Field {
  std::vector<Vec3> sum;
  std::vector<int> count;
  explicit Field(std::size_t n) : sum(n, Vec3::Zero()), count(n, 0) {}
  void add(Index node, const Vec3& change) {
    sum[node] += change;
    ++count[node];
  }
};

// Moves the edge by d against the triangle, by the least change of the free nodes.
void add_pair(const ContourEnd& end, const Vec3& d, std::span<const std::uint8_t> held,
              Field& field) {
  double compliance = 0.0;
  for (int k = 0; k < 5; ++k) compliance += held[end.node[k]] ? 0.0 : end.weight[k] * end.weight[k];
  if (compliance < 1e-6) return;
  for (int k = 0; k < 5; ++k)
    if (!held[end.node[k]] && end.weight[k] != 0.0)
      field.add(end.node[k], (end.weight[k] / compliance) * d);
}

void add_gradients(std::span<const ContourEnd> ends, double step,
                   std::span<const std::uint8_t> held, Field& field) {
  for (const ContourEnd& end : ends) {
    const Vec3& g = end.gradient;
    add_pair(end, (step / std::sqrt(g.squaredNorm() + small_gradient * small_gradient)) * g, held,
             field);
  }
}

// At their rims, which also moves what they have gone through, and where a spot
// is a solid's, only that.
void add_spots(std::span<const ContourEnd> ends, const ContourRegions& regions, double step,
               std::span<const std::uint8_t> held, Field& field) {
  for (const ContourEnd& end : ends)
    for (int k = 0; k < 2; ++k)
      if (const Vec3& way = regions.way[regions.region[end.node[k]]]; way != Vec3::Zero())
        add_pair(end, step * way, held, field);
}

void move_spots(const ContourRegions& regions, double step, std::span<const std::uint8_t> held,
                std::span<Vec3> x) {
  for (std::size_t v = 0; v < x.size(); ++v)
    if (!held[v]) x[v] += 0.5 * step * regions.way[regions.region[v]];
}

std::optional<Vec3> way_out(const Solid& solid, const Vec3& x, double tolerance) {
  const Pose pose = solid.pose(0.0);
  const SurfacePoint point = closest_surface(solid, pose.to_local(x));
  const double depth = solid.thickness - point.distance;
  if (depth <= tolerance) return {};
  return Vec3(depth * (pose.rotation * point.normal));
}

}  // namespace

Index push_out_of_solids(const UntangleInput& input, std::span<Vec3> x, double tolerance) {
  Index pushed = 0;
  for (std::size_t v = 0; v < x.size(); ++v) {
    if (input.held[v]) continue;
    bool inside = false;
    for (const Solid& solid : input.solids) {
      if (solid.shape == SolidShape::mesh) continue;
      if (const auto way = way_out(solid, x[v], tolerance)) x[v] += *way, inside = true;
    }
    pushed += inside;
  }
  return pushed;
}

Index count_inside_solids(const UntangleInput& input, std::span<const Vec3> x, double tolerance) {
  std::vector<Vec3> copy(x.begin(), x.end());
  return push_out_of_solids(input, copy, tolerance);
}

SeparationResult separate(const UntangleInput& input, const EdgeFaces& faces,
                          std::span<const LengthRange> ranges, BroadPhase& broad_phase,
                          const SeparationWay& way, const UntangleOptions& options,
                          std::span<Vec3> x) {
  SeparationResult result;
  int since_best = 0;
  for (;; ++result.passes) {
    push_out_of_solids(input, x, 0.0);
    std::vector<Intersection> found = find_intersections(broad_phase, x);
    if (result.passes == 0 || found.size() < result.left.size()) {
      result.left = found;
      since_best = 0;
    }
    if (found.empty() || result.passes == options.most_passes || ++since_best > options.patience)
      return result;
    std::vector<ContourEnd> ends;
    for (const Intersection& at : found) ends.push_back(contour_end(input.surface, faces, at, x));
    const ContourRegions regions = contour_regions(input.surface, found, ends);
    Field field(x.size());
    add_gradients(ends, way.step, input.held, field);
    if (way.spots) add_spots(ends, regions, way.step, input.held, field);
    for (std::size_t v = 0; v < x.size(); ++v)
      if (field.count[v] > 0) x[v] += field.sum[v] / field.count[v];
    if (way.spots) move_spots(regions, way.step, input.held, x);
    project_lengths(input.surface, ranges, input.held, x, length_iterations);
  }
}

}  // namespace taut
