#include "taut/picture/shade_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace taut::detail {

namespace {

constexpr float pattern_shade = 0.62F;  // linear share of the colour left on dark cells and lines
constexpr double line_width = 0.09;     // of a cell
constexpr float ground_line_shade = 0.86F;
constexpr float ground_line_width = 0.02F;  // of the spacing

// Area-weighted: cross products of unnormalised edges. Vertices with no area around them keep zero
// and are shaded by their facet.
std::vector<Vec3f> vertex_normals(const Surface& surface) {
  std::vector<Vec3> sums(surface.positions.size(), Vec3::Zero());
  for (const Triangle& t : surface.triangles) {
    const Vec3& a = surface.positions[static_cast<std::size_t>(t[0])];
    const Vec3& b = surface.positions[static_cast<std::size_t>(t[1])];
    const Vec3& c = surface.positions[static_cast<std::size_t>(t[2])];
    const Vec3 area = (b - a).cross(c - a);
    for (const Index v : t) sums[static_cast<std::size_t>(v)] += area;
  }
  std::vector<Vec3f> normals(sums.size());
  std::transform(sums.begin(), sums.end(), normals.begin(),
                 [](const Vec3& n) { return Vec3f(n.stableNormalized().cast<float>()); });
  return normals;
}

std::vector<Vec3f> given_normals(std::span<const Vec3> normals) {
  std::vector<Vec3f> result;
  for (const Vec3& n : normals) result.emplace_back(n.cast<float>());
  return result;
}

bool on_dark_part(Pattern pattern, const Vec2& cell) {
  const Vec2 floor = cell.array().floor();
  if (pattern == Pattern::checker) return std::fmod(std::abs(floor.x() + floor.y()), 2.0) > 0.5;
  // Half a line on each side of a cell's border.
  const Vec2 within = cell - floor;
  const auto near_border = [](double x) { return std::min(x, 1.0 - x) < 0.5 * line_width; };
  return pattern == Pattern::grid && (near_border(within.x()) || near_border(within.y()));
}

}  // namespace

Vec3f to_linear(const Colour& srgb) {
  const auto decode = [](double s) {
    return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
  };
  return {decode(srgb.x()), decode(srgb.y()), decode(srgb.z())};
}

std::uint8_t to_srgb_byte(float linear) {
  const double x = std::clamp(static_cast<double>(linear), 0.0, 1.0);
  const double s = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * s));
}

SurfaceLookup::SurfaceLookup(std::span<const Surface> surfaces, const Vec3& origin) {
  for (const Surface& s : surfaces) {
    Entry e{s.triangles, s.texcoords,     {},   {},  to_linear(s.front), to_linear(s.back),
            s.pattern,   s.pattern_cells, 0.0F, 0.0F};
    e.translucency = static_cast<float>(s.translucency);
    e.gloss = static_cast<float>(s.gloss);
    for (const Vec3& p : s.positions) e.positions.emplace_back((p - origin).cast<float>());
    if (!s.normals.empty())
      e.normals = given_normals(s.normals);
    else if (s.smooth_normals)
      e.normals = vertex_normals(s);
    entries_.push_back(std::move(e));
  }
}

std::optional<ShadePoint> SurfaceLookup::at(const Vec3f& ray_origin, const Vec3f& ray_direction,
                                            const Hits& hits, std::size_t lane) const {
  const Entry& e = entries_[hits.surface[lane]];
  const Triangle& t = e.triangles[hits.triangle[lane]];
  const std::array<std::size_t, 3> v{static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                                     static_cast<std::size_t>(t[2])};
  const Vec3f weights(1.0F - hits.u[lane] - hits.v[lane], hits.u[lane], hits.v[lane]);

  ShadePoint point;
  point.position = ray_origin + hits.distance[lane] * ray_direction;
  const Vec3f area =
      (e.positions[v[1]] - e.positions[v[0]]).cross(e.positions[v[2]] - e.positions[v[0]]);
  const float length = area.norm();
  if (!(length > 0.0F)) return std::nullopt;
  const bool front = area.dot(ray_direction) < 0.0F;
  point.facing = area * ((front ? 1.0F : -1.0F) / length);
  point.normal = point.facing;
  if (!e.normals.empty()) {
    const Vec3f n = weights.x() * e.normals[v[0]] + weights.y() * e.normals[v[1]] +
                    weights.z() * e.normals[v[2]];
    if (n.squaredNorm() > 1e-12F)
      point.normal = n.normalized() * (n.dot(point.facing) < 0.0F ? -1.0F : 1.0F);
  }
  point.colour = front ? e.front : e.back;
  point.translucency = e.translucency;
  point.gloss = e.gloss;
  if (e.pattern != Pattern::none) {
    const Vec3 w = weights.cast<double>();
    const Vec2 uv =
        w.x() * e.texcoords[v[0]] + w.y() * e.texcoords[v[1]] + w.z() * e.texcoords[v[2]];
    if (on_dark_part(e.pattern, uv.cwiseProduct(e.cells))) point.colour *= pattern_shade;
  }
  return point;
}

float Ground::distance(const Vec3f& origin, const Vec3f& direction) const {
  const float never = std::numeric_limits<float>::infinity();
  return origin.z() > z && direction.z() < 0.0F ? (z - origin.z()) / direction.z() : never;
}

ShadePoint Ground::at(const Vec3f& position) const {
  ShadePoint point;
  point.position = position;
  point.facing = point.normal = Vec3f::UnitZ();
  point.colour = colour;
  if (line_spacing > 0.0F) {
    const Vec3f cell = (position - line_offset) / line_spacing;
    const auto on_line = [](float x) {
      return std::abs(x - std::round(x)) < 0.5F * ground_line_width;
    };
    if (on_line(cell.x()) || on_line(cell.y())) point.colour *= ground_line_shade;
  }
  // The camera's target is the origin of coordinates, and the middle of the lit disc.
  const float s =
      std::clamp((fade_end - position.head<2>().norm()) / (fade_end - fade_begin), 0.0F, 1.0F);
  point.cover = s * s * (3.0F - 2.0F * s);
  return point;
}

}  // namespace taut::detail
