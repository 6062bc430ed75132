#pragma once
// Small helpers to look into rendered pictures.

#include <cmath>

#include "taut/picture/render.h"

namespace taut::test {

inline double linear(std::uint8_t byte) {
  const double s = byte / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

// Mean linear colour of the (2 reach + 1)² pixels around the place where `point` is seen.
inline Vec3 colour_at(const Image& image, const Camera& camera, const Vec3& point, int reach = 1) {
  const Projection p = project(camera, point, image.width, image.height);
  Vec3 sum = Vec3::Zero();
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      const std::uint8_t* rgb = image.pixel(static_cast<int>(p.x) + x, static_cast<int>(p.y) + y);
      sum += Vec3(linear(rgb[0]), linear(rgb[1]), linear(rgb[2]));
    }
  return sum / ((2 * reach + 1) * (2 * reach + 1));
}

inline double brightness_at(const Image& image, const Camera& camera, const Vec3& point,
                            int reach = 1) {
  return colour_at(image, camera, point, reach).mean();
}

inline RenderOptions small_picture(int width = 160, int height = 120) {
  RenderOptions options;
  options.width = width;
  options.height = height;
  return options;
}

}  // namespace taut::test
