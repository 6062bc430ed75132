#include "taut/picture/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/picture/lighting.h"

namespace taut {

namespace {

using detail::packet_size;
using detail::Vec3f;
template <class T>
using Packet = detail::Packet<T>;

constexpr double ray_offset = 1e-5;         // of the distance from eye to target
constexpr double ground_fade_begin = 0.35;  // of that distance
constexpr double ground_fade_end = 1.3;
constexpr double key_azimuth_deg = 58.0;  // to the left of the camera, seen from the target
constexpr double key_elevation_deg = 44.0;

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

void check_options(const RenderOptions& o) {
  constexpr int longest = 16384;
  const auto in = [](double x, double low, double high) { return x >= low && x <= high; };
  if (!in(o.width, 1, longest) || !in(o.height, 1, longest))
    throw InputError(fmt::format("picture of {} x {} pixels, expected 1 to {} each", o.width,
                                 o.height, longest));
  if (!in(o.samples, 1, 1024))
    throw InputError(fmt::format("{} samples a pixel, expected 1 to 1024", o.samples));
  if (!in(o.light_diameter_deg, 0, 90))
    throw InputError(
        fmt::format("light diameter {} degrees, expected 0 to 90", o.light_diameter_deg));
  if (!o.light_direction.allFinite()) throw InputError("light direction is not finite");
  if (o.ground && !std::isfinite(*o.ground)) throw InputError("ground height is not finite");
  if (!(o.ground_line_spacing >= 0.0))
    throw InputError(
        fmt::format("ground line spacing {} m, expected at least 0", o.ground_line_spacing));
  for (const Colour* c : {&o.ground_colour, &o.background_top, &o.background_bottom})
    if (!in(c->minCoeff(), 0, 1) || !in(c->maxCoeff(), 0, 1))
      throw InputError("a background or ground colour is outside 0 to 1");
}

// Level with the camera's heading: turned to its left, and up.
Vec3 default_light(const CameraAxes& axes) {
  const Vec3 back = -(axes.forward - axes.forward.z() * Vec3::UnitZ());
  const Vec3 level = back.norm() > 1e-3 ? Vec3(back.normalized()) : Vec3(-axes.up);
  const double azimuth = radians(-key_azimuth_deg), elevation = radians(key_elevation_deg);
  const Vec3 turned = Eigen::AngleAxisd(azimuth, Vec3::UnitZ()) * level;
  return std::cos(elevation) * turned + std::sin(elevation) * Vec3::UnitZ();
}

// The samples of one pixel, linear.
struct PixelSum {
  Vec3f colour = Vec3f::Zero();
  Vec3f lowest = Vec3f::Constant(std::numeric_limits<float>::infinity());
  Vec3f highest = Vec3f::Constant(-std::numeric_limits<float>::infinity());
  int count = 0;

  void add(const Vec3f& sample) {
    colour += sample;
    lowest = lowest.cwiseMin(sample);
    highest = highest.cwiseMax(sample);
    ++count;
  }
  // The samples differ by no more than the colours of an open sky make them.
  bool settled() const {
    return ((highest - lowest).array() < 0.1F * highest.array() + 0.005F).all();
  }
};

struct Pixel {
  Pixel(int x_, int y_, int samples) : x(x_), y(y_), pattern(x_, y_, samples) {}
  int x, y;
  detail::PixelPattern pattern;
  PixelSum sum;
};

class Renderer {
 public:
  Renderer(std::span<const Surface> surfaces, const Camera& camera, const RenderOptions& options);
  Image draw() const;

 private:
  void set_lights(const CameraAxes& axes, double distance);
  void set_ground(const Camera& camera, double distance);
  void draw_row(int y, std::uint8_t* rgb) const;
  // Adds the next `count` samples of each of the pixels, a packet at most together; each ends as
  // background, or as a point of a surface or the ground over it.
  void add_samples(std::span<Pixel* const> pixels, int count) const;
  std::optional<detail::ShadePoint> seen_point(const Vec3f& direction, const detail::Hits& hits,
                                               std::size_t lane) const;
  Vec3f ray_direction(float x, float y) const;
  Vec3f background(float y) const;

  RenderOptions options_;
  detail::RayScene scene_;
  detail::SurfaceLookup lookup_;
  detail::Lights lights_;
  std::optional<detail::Ground> ground_;
  // right_ and up_ reach to the picture's border at unit distance
  Vec3f eye_, right_, up_, forward_;
  Vec3f top_, bottom_;
};

Renderer::Renderer(std::span<const Surface> surfaces, const Camera& camera,
                   const RenderOptions& options)
    : options_(options), scene_(surfaces, camera.target), lookup_(surfaces, camera.target) {
  const CameraAxes axes = camera_axes(camera);
  const double distance = (camera.eye - camera.target).norm();
  const double tangent = std::tan(0.5 * radians(camera.vertical_field_of_view_deg));
  eye_ = (camera.eye - camera.target).cast<float>();
  right_ = (axes.right * tangent * options.width / options.height).cast<float>();
  up_ = (axes.up * tangent).cast<float>();
  forward_ = axes.forward.cast<float>();
  top_ = detail::to_linear(options.background_top);
  bottom_ = detail::to_linear(options.background_bottom);
  set_lights(axes, distance);
  set_ground(camera, distance);
}

void Renderer::set_lights(const CameraAxes& axes, double distance) {
  const Vec3 key =
      options_.light_direction.isZero() ? default_light(axes) : options_.light_direction;
  lights_.key = key.stableNormalized().cast<float>();
  detail::make_frame(lights_.key, lights_.key_x, lights_.key_y);
  lights_.key_radius = static_cast<float>(std::tan(0.5 * radians(options_.light_diameter_deg)));
  lights_.offset = static_cast<float>(ray_offset * distance);
}

void Renderer::set_ground(const Camera& camera, double distance) {
  if (!options_.ground) return;
  detail::Ground ground;
  ground.z = static_cast<float>(*options_.ground - camera.target.z());
  ground.fade_begin = static_cast<float>(ground_fade_begin * distance);
  ground.fade_end = static_cast<float>(ground_fade_end * distance);
  ground.line_spacing = static_cast<float>(options_.ground_line_spacing);
  ground.colour = detail::to_linear(options_.ground_colour);
  ground.line_offset = (-camera.target).cast<float>();
  lights_.has_ground = true;
  lights_.ground_bounce = 0.6F * ground.colour;
  ground_ = ground;
}

Image Renderer::draw() const {
  Image image{options_.width, options_.height, {}};
  const std::size_t row = 3 * static_cast<std::size_t>(image.width);
  image.rgb.resize(row * static_cast<std::size_t>(image.height));
  parallel_for(image.height, 2, [&](Index begin, Index end) {
    for (Index y = begin; y < end; ++y)
      draw_row(y, image.rgb.data() + row * static_cast<std::size_t>(y));
  });
  return image;
}

// Most pixels are settled by half of their samples: the others go only where those differ
// (outlines, soft shadows, creases). Where that is less than a packet, pixels of a row share one.
void Renderer::draw_row(int y, std::uint8_t* rgb) const {
  std::vector<Pixel> pixels;
  std::vector<Pixel*> open;
  for (int x = 0; x < options_.width; ++x) pixels.emplace_back(x, y, options_.samples);
  for (Pixel& pixel : pixels) open.push_back(&pixel);
  for (int done = 0; done < options_.samples && !open.empty();) {
    const int half = std::min(packet_size, std::max(4, options_.samples / 2));
    const int count = std::min(half, options_.samples - done);
    const auto sharing = static_cast<std::size_t>(packet_size / count);
    for (std::size_t k = 0; k < open.size(); k += sharing)
      add_samples(std::span(open).subspan(k, std::min(sharing, open.size() - k)), count);
    done += count;
    if (2 * done >= options_.samples)
      std::erase_if(open, [](const Pixel* pixel) { return pixel->sum.settled(); });
  }
  for (const Pixel& pixel : pixels) {
    const Vec3f colour = pixel.sum.colour / static_cast<float>(pixel.sum.count);
    for (int k = 0; k < 3; ++k) *rgb++ = detail::to_srgb_byte(colour[k]);
  }
}

Vec3f Renderer::ray_direction(float x, float y) const {
  const float across = 2.0F * x / static_cast<float>(options_.width) - 1.0F;
  const float upward = 1.0F - 2.0F * y / static_cast<float>(options_.height);
  return (forward_ + across * right_ + upward * up_).normalized();
}

Vec3f Renderer::background(float y) const {
  const float s = y / static_cast<float>(options_.height);
  return top_ + s * (bottom_ - top_);
}

std::optional<detail::ShadePoint> Renderer::seen_point(const Vec3f& direction,
                                                       const detail::Hits& hits,
                                                       std::size_t lane) const {
  const float ground_distance =
      ground_ ? ground_->distance(eye_, direction) : std::numeric_limits<float>::infinity();
  if (hits.distance[lane] < ground_distance) return lookup_.at(eye_, direction, hits, lane);
  if (std::isfinite(ground_distance)) return ground_->at(eye_ + ground_distance * direction);
  return std::nullopt;
}

void Renderer::add_samples(std::span<Pixel* const> pixels, int count) const {
  const std::size_t lanes = pixels.size() * static_cast<std::size_t>(count);
  const auto pixel_of = [&](std::size_t lane) -> Pixel& {
    return *pixels[lane / static_cast<std::size_t>(count)];
  };
  Packet<detail::PixelSample> samples;
  detail::Rays rays;
  Packet<float> rows;
  for (std::size_t i = 0; i < lanes; ++i) {
    const Pixel& pixel = pixel_of(i);
    samples[i] = {&pixel.pattern,
                  static_cast<std::uint32_t>(pixel.sum.count) +
                      static_cast<std::uint32_t>(i) % static_cast<std::uint32_t>(count)};
    const auto jitter = pixel.pattern.place.at(samples[i].number);
    rows[i] = static_cast<float>(pixel.y) + jitter[1];
    rays.active[i] = true;
    rays.origin[i] = eye_;
    rays.direction[i] = ray_direction(static_cast<float>(pixel.x) + jitter[0], rows[i]);
  }
  detail::Hits hits;
  scene_.nearest_hits(rays, hits);

  Packet<detail::ShadePoint> points;
  Packet<bool> lit{};
  for (std::size_t i = 0; i < lanes; ++i) {
    const std::optional<detail::ShadePoint> point = seen_point(rays.direction[i], hits, i);
    lit[i] = point && point->cover > 0.0F;
    if (lit[i]) points[i] = *point;
  }
  Packet<Vec3f> colours;
  if (lit != Packet<bool>{})
    detail::light_points(scene_, lights_, samples, points, lit, rays.direction, colours);
  for (std::size_t i = 0; i < lanes; ++i) {
    const Vec3f behind = background(rows[i]);
    pixel_of(i).sum.add(lit[i] ? Vec3f(behind + points[i].cover * (colours[i] - behind)) : behind);
  }
}

}  // namespace

Image render(std::span<const Surface> surfaces, const Camera& camera,
             const RenderOptions& options) {
  check_options(options);
  camera_axes(camera);
  for (const Surface& surface : surfaces) check_surface(surface);
  return Renderer(surfaces, camera, options).draw();
}

}  // namespace taut
