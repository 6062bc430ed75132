#include "taut/results/frame_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/error.h"
#include "taut/picture/contact_sheet.h"
#include "taut/sim/cloth_model.h"

namespace taut {

namespace {

// Frames looked at to place the camera: a cloth hardly leaves the box of so many.
constexpr int most_frames_looked_at = 24;
// Of these colours solids take one after the other.
const Colour solid_colours[] = {Colour(0.80, 0.78, 0.74), Colour(0.62, 0.68, 0.62),
                                Colour(0.74, 0.63, 0.60), Colour(0.62, 0.64, 0.72)};

// Cloths likewise, front and back; as in the viewer.
struct ClothColours {
  Colour front, back;
};
const ClothColours cloth_colours[] = {{Colour(0.22, 0.47, 0.74), Colour(0.93, 0.64, 0.27)},
                                      {Colour(0.71, 0.33, 0.24), Colour(0.44, 0.68, 0.62)},
                                      {Colour(0.36, 0.55, 0.24), Colour(0.72, 0.50, 0.71)},
                                      {Colour(0.48, 0.38, 0.70), Colour(0.79, 0.71, 0.35)}};

bool is_level_plane(const SolidShapes& solids, std::size_t k) {
  const Solid& solid = solids.solid(k);
  return solid.shape == SolidShape::plane && !solids.moves(k) &&
         (solid.pose(0.0).rotation * Vec3::UnitZ()).z() > 1.0 - 1e-9;
}

BoundingBox box_of(std::span<const Vec3> points) {
  BoundingBox box;
  for (const Vec3& x : points) box.extend(x);
  return box;
}

// Points of the solids that belong into the picture: those of no more than this size, and near,
// both measured by the extent of the cloths.
constexpr double largest_solid = 1.6, farthest_solid = 0.6;

void add_solids_in_view(const SolidShapes& solids, std::span<const double> times,
                        std::vector<Vec3>& points) {
  const BoundingBox cloths = box_of(points);
  const double size = cloths.diagonal().norm();
  for (std::size_t k = 0; k < solids.size(); ++k) {
    if (solids.solid(k).shape == SolidShape::plane) continue;
    for (const double time : solids.moves(k) ? times : times.first(1)) {
      const std::vector<Vec3> mesh = solids.at(k, time).mesh.positions;
      const BoundingBox box = box_of(mesh);
      if (box.diagonal().norm() <= largest_solid * size &&
          cloths.exteriorDistance(box.center()) <= farthest_solid * cloths.sizes().maxCoeff())
        points.insert(points.end(), mesh.begin(), mesh.end());
    }
  }
}

// Of cloths and solids, a ground that hid some of them would be worse than one that is far away.
double lowest_of(const SolidShapes& solids, std::span<const double> times,
                 std::span<const Vec3> points) {
  double lowest = box_of(points).min().z();
  for (std::size_t k = 0; k < solids.size(); ++k) {
    if (solids.solid(k).shape == SolidShape::plane) continue;
    for (const double time : solids.moves(k) ? times : times.first(1))
      lowest = std::min(lowest, box_of(solids.at(k, time).mesh.positions).min().z());
  }
  return lowest;
}

bool has_texcoords(std::span<const Vec2> texcoords) {
  return std::any_of(texcoords.begin(), texcoords.end(),
                     [&](const Vec2& uv) { return uv != texcoords.front(); });
}

// A flat patch in cloth coordinates of about 5 cm, so that stretch shows.
Vec2 pattern_cells(const ClothModel& cloth, const ClothPart& part) {
  const BoundingBox box =
      box_of(std::span(cloth.start().x).subspan(part.first_node, part.node_count));
  const double cells = std::clamp(box.sizes().maxCoeff() / 0.05, 4.0, 40.0);
  return {std::round(cells), std::round(cells)};
}

Surface cloth_surface(const ClothModel& cloth, std::size_t k, std::span<const Vec3> x,
                      Pattern pattern) {
  const ClothPart& part = cloth.parts()[k];
  Surface surface;
  surface.name = part.name;
  surface.front = cloth_colours[k % std::size(cloth_colours)].front;
  surface.back = cloth_colours[k % std::size(cloth_colours)].back;
  surface.positions = x;
  surface.triangles =
      std::span(cloth.surface().triangles).subspan(part.first_triangle, part.triangle_count);
  surface.texcoords = cloth.surface().texcoords;
  const std::span<const Vec2> own = surface.texcoords.subspan(part.first_node, part.node_count);
  surface.pattern = has_texcoords(own) ? pattern : Pattern::none;
  surface.pattern_cells = pattern_cells(cloth, part);
  return surface;
}

}  // namespace

Image draw_scene(const ClothModel& cloth, std::span<const Vec3> x, const SolidShapes& solids,
                 double time, const Camera& camera, const RenderOptions& options, Pattern pattern,
                 Index without_solid) {
  std::vector<SolidMesh> meshes;
  for (std::size_t k = 0; k < solids.size(); ++k)
    if (static_cast<Index>(k) != without_solid) meshes.push_back(solids.at(k, time));
  std::vector<Surface> surfaces;
  for (std::size_t k = 0; k < meshes.size(); ++k)
    surfaces.push_back(solid_surface(meshes[k], solid_colours[k % std::size(solid_colours)]));
  for (std::size_t k = 0; k < cloth.parts().size(); ++k)
    surfaces.push_back(cloth_surface(cloth, k, x, pattern));
  return render(surfaces, camera, options);
}

FramePictures::FramePictures(const Scene& scene, const ClothModel& cloth,
                             const ResultsFolder& results, std::span<const int> frames,
                             const PictureOptions& options)
    : scene_(scene), solids_(scene), cloth_(cloth), results_(results), options_(options) {
  if (frames.empty())
    throw InputError({results.folder().string()}, "holds no frames; run a scene into it first");
  std::vector<Vec3> points;
  std::vector<double> times;
  for (const int k : spread_frames(static_cast<int>(frames.size()) - 1, most_frames_looked_at)) {
    const std::vector<Vec3> x = results.read_frame(frames[static_cast<std::size_t>(k)]);
    points.insert(points.end(), x.begin(), x.end());
    times.push_back(time_of(frames[static_cast<std::size_t>(k)]));
  }
  const SolidShapes coarse(scene, 24);
  add_solids_in_view(coarse, times, points);
  render_.width = options.width;
  render_.height = options.height;
  render_.samples = options.samples;
  look_at(points);
  if (options.ground) place_ground(points, lowest_of(coarse, times, points));
}

void FramePictures::look_at(const std::vector<Vec3>& points) {
  FramingOptions framing;
  framing.aspect = static_cast<double>(options_.width) / options_.height;
  framing.vertical_field_of_view_deg = options_.vertical_field_of_view_deg;
  const Vec3 middle = options_.at.value_or(box_of(points).center());
  if (options_.from) {
    camera_ = {*options_.from, middle, Vec3::UnitZ(), options_.vertical_field_of_view_deg};
    return;
  }
  camera_ = frame_camera(points, framing);
  if (options_.at) {
    camera_.eye += *options_.at - camera_.target;
    camera_.target = *options_.at;
  }
}

void FramePictures::place_ground(const std::vector<Vec3>& points, double lowest) {
  const BoundingBox box = box_of(points);
  for (std::size_t k = 0; k < solids_.size() && plane_drawn_as_ground_ < 0; ++k)
    if (is_level_plane(solids_, k)) plane_drawn_as_ground_ = static_cast<Index>(k);
  // What stands on the ground may end a rounding, or the cut of a mesh, below it.
  constexpr double hair = 2e-3;
  const double size = box.sizes().maxCoeff();
  if (plane_drawn_as_ground_ >= 0)
    render_.ground =
        solids_.solid(static_cast<std::size_t>(plane_drawn_as_ground_)).pose(0.0).translation.z();
  else if (lowest >= -hair * size && lowest <= size)
    render_.ground = std::min(0.0, lowest);
  else
    render_.ground = lowest - 0.03 * size;
}

Image FramePictures::draw(int frame) const {
  const std::vector<Vec3> x = results_.read_frame(frame);
  if (static_cast<Index>(x.size()) != cloth_.nodes())
    throw InputError({results_.frame_file(frame).string()},
                     fmt::format("has {} nodes, the scene has {}", x.size(), cloth_.nodes()));
  return draw_scene(cloth_, x, solids_, time_of(frame), camera_, render_, options_.pattern,
                    plane_drawn_as_ground_);
}

std::vector<int> spread_frames(int last, int count) {
  const int chosen = std::min(count, last + 1);
  std::vector<int> frames;
  for (int t = 0; t < chosen; ++t)
    frames.push_back(chosen == 1 ? last : static_cast<int>(std::int64_t{t} * last / (chosen - 1)));
  return frames;
}

void draw_contact_sheet(const std::filesystem::path& path, const Scene& scene,
                        const ClothModel& cloth, const ResultsFolder& results,
                        std::span<const int> frames, const PictureOptions& options) {
  const FramePictures pictures(scene, cloth, results, frames, options);
  std::vector<Tile> tiles;
  for (const int frame : frames)
    tiles.push_back({pictures.draw(frame), fmt::format("t = {:.3f} s", pictures.time_of(frame))});
  write_contact_sheet(
      path, tiles,
      fmt::format("{}{}({} nodes)", scene.title, scene.title.empty() ? "" : "   ", cloth.nodes()));
}

}  // namespace taut
