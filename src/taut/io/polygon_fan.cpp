#include "taut/io/polygon_fan.h"

#include <Eigen/Geometry>

namespace taut {

namespace {

// Beyond this many corners only the plain fan is tried: the search is quadratic, and a file may
// hold a polygon of a million corners.
constexpr std::size_t most_searched = 64;

Triangle fan_triangle(std::span<const Index> corner, std::size_t start, std::size_t k) {
  const std::size_t n = corner.size();
  return {corner[start], corner[(start + k) % n], corner[(start + k + 1) % n]};
}

bool folds(std::span<const Index> corner, std::size_t start, std::span<const Vec3> positions,
           const Vec3& normal) {
  for (std::size_t k = 1; k + 1 < corner.size(); ++k) {
    const Triangle t = fan_triangle(corner, start, k);
    const Vec3 area = (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]);
    // Corners on a straight line may turn either way by rounding.
    if (area.dot(normal) < -1e-9 * normal.squaredNorm()) return true;
  }
  return false;
}

}  // namespace

std::optional<Index> unfolded_fan_start(std::span<const Index> corner,
                                        std::span<const Vec3> positions) {
  if (corner.size() <= 3) return 0;
  Vec3 normal = Vec3::Zero();
  const Vec3 first = positions[corner[0]];
  for (std::size_t i = 1; i + 1 < corner.size(); ++i)
    normal += (positions[corner[i]] - first).cross(positions[corner[i + 1]] - first);
  const std::size_t starts = corner.size() <= most_searched ? corner.size() : 1;
  for (std::size_t start = 0; start < starts; ++start)
    if (!folds(corner, start, positions, normal)) return static_cast<Index>(start);
  return std::nullopt;
}

void append_fan(std::span<const Index> corner, Index start, std::vector<Triangle>& triangles) {
  for (std::size_t k = 1; k + 1 < corner.size(); ++k)
    triangles.push_back(fan_triangle(corner, static_cast<std::size_t>(start), k));
}

}  // namespace taut
