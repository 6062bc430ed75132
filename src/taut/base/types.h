#pragma once
// The few types that every room shares.
//
//   Vec3, Mat3   3-vectors and 3x3 matrices of doubles (Eigen, column-major)
//   Index        signed 32-bit counter of nodes, blocks and unknowns: 2^31 unknowns are beyond a
//                processor's memory here
//   flat(x)      N node vectors seen as 3N doubles x0 y0 z0 x1 ...: the order of every vector of
//                the linear system

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace taut {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Index = std::int32_t;
using Offset = std::int64_t;

static_assert(sizeof(Vec3) == 3 * sizeof(double), "flat() needs packed node vectors");

inline std::span<double> flat(std::span<Vec3> nodes) {
  return {nodes.empty() ? nullptr : nodes.front().data(), 3 * nodes.size()};
}
inline std::span<const double> flat(std::span<const Vec3> nodes) {
  return {nodes.empty() ? nullptr : nodes.front().data(), 3 * nodes.size()};
}
inline std::span<double> flat(std::vector<Vec3>& nodes) { return flat(std::span<Vec3>(nodes)); }
inline std::span<const double> flat(const std::vector<Vec3>& nodes) {
  return flat(std::span<const Vec3>(nodes));
}

}  // namespace taut
