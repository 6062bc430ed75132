#pragma once
// The lights of a picture, and how much of their light eight points give back. Only for the sources
// of this folder.

#include "taut/picture/sampling.h"
#include "taut/picture/shade_point.h"

namespace taut::detail {

struct Lights {
  Vec3f key;                // unit vector towards the middle of the key light
  Vec3f key_x, key_y;       // unit vectors across it
  float key_radius = 0.0F;  // tangent of half the angle it is seen under
  bool has_ground = false;
  Vec3f ground_bounce;  // light from below where there is a ground
  float offset = 0.0F;  // m: rays start this far off the surface, so that they do not hit it
};

// The samples of one pixel: where in the pixel, which part of the key light,
// which direction of the sky.
struct PixelPattern {
  PixelPattern(int x, int y, int samples)
      : place(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
              static_cast<std::uint32_t>(samples), 1),
        key(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
            static_cast<std::uint32_t>(samples), 2),
        sky(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
            static_cast<std::uint32_t>(samples), 3) {}
  PixelSamples place, key, sky;
};

// A sample of a pixel.
struct PixelSample {
  const PixelPattern* pattern = nullptr;
  std::uint32_t number = 0;
};

// Linear colours, rolled off below 1, of the points whose lane is active. view: unit vectors from
// the camera to the points.
void light_points(const RayScene& scene, const Lights& lights, const Packet<PixelSample>& samples,
                  const Packet<ShadePoint>& points, const Packet<bool>& active,
                  const Packet<Vec3f>& view, Packet<Vec3f>& colours);

// Any two unit vectors that make a right-handed frame with the unit vector n.
void make_frame(const Vec3f& n, Vec3f& x, Vec3f& y);

}  // namespace taut::detail
