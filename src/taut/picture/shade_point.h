#pragma once
// What a ray has met, ready to be lit: position, normals turned to the viewer, colour with its
// pattern. Only for the sources of this folder. All vectors are in single precision, positions
// relative to the same origin as the RayScene.

#include <optional>
#include <vector>

#include "taut/picture/ray_scene.h"

namespace taut::detail {

struct ShadePoint {
  Vec3f position;
  Vec3f facing;  // geometric unit normal on the viewer's side
  Vec3f normal;  // interpolated unit normal on the viewer's side
  Vec3f colour;  // linear, the share of light given back
  float translucency = 0.0F;
  float gloss = 0.0F;
  float cover = 1.0F;  // 0: the background shows fully
};

// sRGB in [0, 1] to linear, and back to a byte.
Vec3f to_linear(const Colour& srgb);
std::uint8_t to_srgb_byte(float linear);

// Surfaces with everything that shading looks up per hit.
class SurfaceLookup {
 public:
  SurfaceLookup(std::span<const Surface> surfaces, const Vec3& origin);
  // `ray_direction` has unit length. Nothing for a hit on a triangle without area.
  std::optional<ShadePoint> at(const Vec3f& ray_origin, const Vec3f& ray_direction,
                               const Hits& hits, std::size_t lane) const;

 private:
  struct Entry {
    std::span<const Triangle> triangles;
    std::span<const Vec2> texcoords;
    std::vector<Vec3f> positions, normals;  // normals: empty for facets
    Vec3f front, back;
    Pattern pattern;
    Vec2 cells;
    float translucency, gloss;
  };
  std::vector<Entry> entries_;
};

// The ground: a horizontal plane that fades into the background away from `centre`.
struct Ground {
  float z = 0.0F;
  float fade_begin = 1.0F, fade_end = 2.0F;  // m from the centre
  float line_spacing = 0.0F;                 // m; 0 draws no lines
  Vec3f colour;                              // linear
  Vec3f line_offset = Vec3f::Zero();         // where the world's origin lies
  // Where a ray from above meets it: the distance, infinite if never.
  float distance(const Vec3f& origin, const Vec3f& direction) const;
  ShadePoint at(const Vec3f& position) const;
};

}  // namespace taut::detail
