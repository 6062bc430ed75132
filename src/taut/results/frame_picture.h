#pragma once
// Pictures of the frames of a run: cloths in two colours, solids, a ground. One camera, light and
// ground for all frames, so that they make a film.
//
// Camera: given, or the closest one in the usual direction that has the cloths of all chosen frames
// in view, and the solids that stand still and are not much larger than they. A moving solid may
// fly in and out. Ground: a level plane of the scene; else z = 0 if all is above it, to a hair, and
// not far (within the size of what is in view); else just below everything: cloths and all solids
// but planes, in view or not.

#include <optional>

#include "taut/picture/render.h"
#include "taut/results/results.h"
#include "taut/results/solid_shapes.h"
#include "taut/sim/cloth_model.h"

namespace taut {

struct PictureOptions {
  int width = 1280, height = 720;  // pixels
  int samples = 16;                // per pixel
  // m: where the camera is, and what is in the middle; without `at` the middle of what there is
  std::optional<Vec3> from, at;
  double vertical_field_of_view_deg = 28.0;
  Pattern pattern = Pattern::grid;  // from (u, v); cloths without them have none
  bool ground = true;
};

// One picture: the cloths with their nodes at `x`, the solids at `time` (s). `options` has size,
// samples and ground; a solid `without_solid` is left out (a plane that is the ground).
Image draw_scene(const ClothModel& cloth, std::span<const Vec3> x, const SolidShapes& solids,
                 double time, const Camera& camera, const RenderOptions& options,
                 Pattern pattern = Pattern::grid, Index without_solid = -1);

class FramePictures {
 public:
  // `frames`: those that will be drawn, to place the camera and the ground. The arguments must
  // outlive this. Throws InputError for bad options and unreadable frames.
  FramePictures(const Scene& scene, const ClothModel& cloth, const ResultsFolder& results,
                std::span<const int> frames, const PictureOptions& options);

  Image draw(int frame) const;
  // Its height, m; none without PictureOptions::ground.
  std::optional<double> ground() const { return render_.ground; }
  double time_of(int frame) const { return frame * scene_.time.step * scene_.time.steps_per_frame; }

 private:
  void look_at(const std::vector<Vec3>& points);
  void place_ground(const std::vector<Vec3>& points, double lowest);

  const Scene& scene_;
  SolidShapes solids_;
  const ClothModel& cloth_;
  const ResultsFolder& results_;
  PictureOptions options_;
  Camera camera_;
  RenderOptions render_;
  Index plane_drawn_as_ground_ = -1;
};

// `count` of the frames 0 ... last, evenly spread, the first and the last among them.
std::vector<int> spread_frames(int last, int count);

// Those frames side by side with their times, written to `path`.
void draw_contact_sheet(const std::filesystem::path& path, const Scene& scene,
                        const ClothModel& cloth, const ResultsFolder& results,
                        std::span<const int> frames, const PictureOptions& options);

}  // namespace taut
