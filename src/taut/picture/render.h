#pragma once
// Pictures of cloth and solids by ray tracing on the CPU; needs no display and no GPU. The light
// given back by a point with normal n and colour c, seen from its own side:
//
//   L = c * (K * max(0, n·l) * V(l) + S)
//
//   K, l   the key light: a far disc of a few degrees, from the upper left behind the camera
//   V      its visibility (soft shadows)
//   S      the mean of sky(d) over directions d drawn with density (n·d)/π: light of the sky and,
//          from below, of the ground (ambient occlusion)
//
// What else gives light, and how pixels are sampled: docs/design/pictures.md. The picture has the
// same bits for any thread count and from run to run on one instruction set. The same camera gives
// the same lights and ground in every frame of a film.

#include <optional>
#include <span>

#include "taut/picture/camera.h"
#include "taut/picture/image.h"
#include "taut/picture/surface.h"

namespace taut {

struct RenderOptions {
  int width = 1280, height = 720;  // pixels, each 1 to 16384
  int samples = 16;                // per pixel, 1 to 1024; powers of two are best
  // m: height z of a ground that receives shadows; fades out away from the camera's target
  std::optional<double> ground;
  Colour ground_colour = Colour(0.86, 0.86, 0.85);
  // m between thin lines on the ground through the world's origin; 0 draws none
  double ground_line_spacing = 0.0;
  Colour background_top = Colour(0.80, 0.85, 0.91);
  Colour background_bottom = Colour(0.95, 0.95, 0.94);
  // towards the key light, any length; zero chooses it from the camera
  Vec3 light_direction = Vec3::Zero();
  double light_diameter_deg = 9.0;  // seen from the scene: larger is softer, 0 to 90
};

// Draws the surfaces. Throws InputError for a bad surface (check_surface), camera (camera_axes) or
// option. No surfaces: background and ground. Memory: about 0.3 kB a triangle. Runs on
// thread_count() threads.
Image render(std::span<const Surface> surfaces, const Camera& camera,
             const RenderOptions& options = {});

}  // namespace taut
