#pragma once
// Rays against triangle meshes, by Embree, in packets of eight. Single precision, coordinates
// relative to `origin`. Only for the sources of this folder. Queries are const and may be made from
// several threads.

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "taut/picture/surface.h"

namespace taut::detail {

using Vec3f = Eigen::Vector3f;

constexpr int packet_size = 8;
template <class T>
using Packet = std::array<T, packet_size>;

struct Rays {
  Packet<Vec3f> origin, direction;
  Packet<bool> active{};
  float near = 0.0F;
};

struct Hits {
  Packet<float> distance;          // along direction; infinite where nothing is hit
  Packet<float> u, v;              // barycentric weights of the triangle's second and third vertex
  Packet<std::uint32_t> surface;   // index into the surfaces
  Packet<std::uint32_t> triangle;  // index into its triangles
};

class RayScene {
 public:
  // Surfaces must have passed check_surface.
  RayScene(std::span<const Surface> surfaces, const Vec3& origin);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  void nearest_hits(const Rays& rays, Hits& hits) const;
  // True where something stands in the way, however far.
  void blocked(const Rays& rays, Packet<bool>& result) const;

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace taut::detail
