#include "taut/picture/lighting.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace taut::detail {

namespace {

constexpr float two_pi = 2.0F * std::numbers::pi_v<float>;
constexpr float gloss_exponent = 48.0F;
constexpr float shoulder = 0.8F;

// Linear radiance; together a white surface facing the key light gives back about 1.3, which is
// rolled off. The key light is about twice the sky, so that folds show.
const Vec3f key_light(0.88F, 0.845F, 0.785F);
const Vec3f sky_zenith(0.395F, 0.425F, 0.475F);
const Vec3f sky_horizon(0.45F, 0.44F, 0.43F);
const Vec3f below_without_ground(0.28F, 0.275F, 0.265F);
constexpr float blocked_light = 0.11F;       // from whatever blocks the sky
constexpr float blocked_own_colour = 0.30F;  // what blocks is mostly the cloth itself

Vec3f disc_point(const Vec3f& centre, const Vec3f& x, const Vec3f& y, float radius,
                 const std::array<float, 2>& s) {
  const float r = radius * std::sqrt(s[0]), angle = two_pi * s[1];
  return centre + r * std::cos(angle) * x + r * std::sin(angle) * y;
}

Vec3f sky(const Lights& lights, const Vec3f& d) {
  if (d.z() >= 0.0F) return sky_horizon + d.z() * (sky_zenith - sky_horizon);
  const Vec3f& below = lights.has_ground ? lights.ground_bounce : below_without_ground;
  // A quick but smooth change at the horizon: a step would draw a line across round solids.
  return sky_horizon + std::min(1.0F, -4.0F * d.z()) * (below - sky_horizon);
}

// Light above the shoulder approaches 1 and keeps its hue better than cutting would.
Vec3f roll_off(const Vec3f& light) {
  return light.unaryExpr([](float x) {
    return x <= shoulder ? x
                         : shoulder + (1.0F - shoulder) *
                                          (1.0F - std::exp((shoulder - x) / (1.0F - shoulder)));
  });
}

Vec3f key_part(const Lights& lights, const ShadePoint& p, const Vec3f& to_light,
               const Vec3f& view) {
  const float cosine = p.normal.dot(to_light);
  if (p.facing.dot(to_light) <= 0.0F)
    return p.translucency * std::max(0.0F, -cosine) * key_light.cwiseProduct(p.colour);
  Vec3f light = std::max(0.0F, cosine) * key_light.cwiseProduct(p.colour);
  if (p.gloss > 0.0F) {
    const float half = std::max(0.0F, p.normal.dot((lights.key - view).normalized()));
    light += p.gloss * std::pow(half, gloss_exponent) * key_light;
  }
  return light;
}

}  // namespace

void make_frame(const Vec3f& n, Vec3f& x, Vec3f& y) {
  x = n.cross(std::abs(n.z()) < 0.9F ? Vec3f::UnitZ() : Vec3f::UnitX()).normalized();
  y = n.cross(x);
}

void light_points(const RayScene& scene, const Lights& lights, const Packet<PixelSample>& samples,
                  const Packet<ShadePoint>& points, const Packet<bool>& active,
                  const Packet<Vec3f>& view, Packet<Vec3f>& colours) {
  Rays key_rays, sky_rays;
  for (std::size_t i = 0; i < packet_size; ++i) {
    key_rays.active[i] = sky_rays.active[i] = active[i];
    if (!active[i]) continue;
    const ShadePoint& p = points[i];
    const auto& [pattern, number] = samples[i];
    key_rays.direction[i] = disc_point(lights.key, lights.key_x, lights.key_y, lights.key_radius,
                                       pattern->key.at(number))
                                .normalized();
    const float side = p.facing.dot(key_rays.direction[i]) > 0.0F ? 1.0F : -1.0F;
    key_rays.origin[i] = p.position + side * lights.offset * p.facing;

    // A point of the unit disc lifted onto the hemisphere has the density cosine / pi.
    Vec3f x, y;
    make_frame(p.normal, x, y);
    const Vec3f flat = disc_point(Vec3f::Zero(), x, y, 1.0F, pattern->sky.at(number));
    sky_rays.direction[i] = flat + std::sqrt(std::max(0.0F, 1.0F - flat.squaredNorm())) * p.normal;
    sky_rays.origin[i] = p.position + lights.offset * p.facing;
  }
  Packet<bool> key_blocked, sky_blocked;
  scene.blocked(key_rays, key_blocked);
  scene.blocked(sky_rays, sky_blocked);
  for (std::size_t i = 0; i < packet_size; ++i) {
    if (!active[i]) continue;
    const ShadePoint& p = points[i];
    Vec3f around = sky_blocked[i]
                       ? Vec3f(Vec3f::Constant(blocked_light) + blocked_own_colour * p.colour)
                       : sky(lights, sky_rays.direction[i]);
    Vec3f light = around.cwiseProduct(p.colour);
    if (!key_blocked[i]) light += key_part(lights, p, key_rays.direction[i], view[i]);
    colours[i] = roll_off(light);
  }
}

}  // namespace taut::detail
