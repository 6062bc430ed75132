#include <fmt/format.h>

#include "taut/base/error.h"
#include "taut/io/obj.h"
#include "taut/picture/contact_sheet.h"
#include "taut/picture/render.h"
#include "taut/scene/run.h"
#include "taut/scene/solid_shapes.h"

namespace taut {

namespace {

constexpr int most_tiles = 6;
constexpr int tile_width = 480, tile_height = 400;

// Evenly spread over what there is, the first and the last among them.
std::vector<int> chosen_frames(int count) {
  const int tiles = std::min(count, most_tiles);
  std::vector<int> frames;
  for (int t = 0; t < tiles; ++t) frames.push_back(tiles == 1 ? 0 : t * (count - 1) / (tiles - 1));
  return frames;
}

// A flat patch in cloth coordinates of about 5 cm, so that stretch shows.
Vec2 checker_cells(const ClothModel& cloth, const ClothPart& part) {
  BoundingBox box;
  for (Index i = 0; i < part.node_count; ++i) box.extend(cloth.start().x[part.first_node + i]);
  const double cells = std::clamp(box.sizes().maxCoeff() / 0.05, 4.0, 40.0);
  return {std::round(cells), std::round(cells)};
}

// The scene at this time, with the cloths at x.
Image draw(const Simulation& simulation, double time, std::span<const Vec3> x, const Camera& camera, const RenderOptions& options) {
  const ClothModel& cloth = simulation.cloth();
  std::vector<SolidMesh> solids;
  for (const Solid& solid : simulation.scene().solids)
    if (solid.shape != SolidShape::mesh) solids.push_back(mesh_of(solid, time));
  if (simulation.surface_contact())
    for (const MeshSolid& solid : simulation.surface_contact()->solids()) solids.push_back(mesh_of(solid, time));
  std::vector<Surface> surfaces;
  for (const SolidMesh& solid : solids) surfaces.push_back(solid_surface(solid));
  for (const ClothPart& part : cloth.parts()) {
    Surface surface;
    surface.name = part.name;
    surface.positions = x;
    surface.triangles = std::span(cloth.surface().triangles).subspan(part.first_triangle, part.triangle_count);
    surface.texcoords = cloth.surface().texcoords;
    surface.pattern = Pattern::grid;
    surface.pattern_cells = checker_cells(cloth, part);
    surfaces.push_back(surface);
  }
  return render(surfaces, camera, options);
}

}  // namespace

std::filesystem::path save_last_good(const Simulation& simulation, const ResultsFolder& results) {
  const std::filesystem::path folder = results.folder() / "last_good";
  const SurfaceContact* contact = simulation.surface_contact();
  const State& state = simulation.state();
  TriangleMesh all = simulation.cloth().surface();
  all.positions = state.x;
  all.texcoords.clear();
  if (contact) {
    all.positions = contact->positions(state.time, state.x);
    all.triangles = contact->contact().surface().triangles;
  }
  write_obj(folder / "surface.obj", all);
  if (!contact || contact->contact().trouble().empty()) return folder;
  std::vector<Vec3> in_view;
  for (const Index node : contact->contact().trouble())
    for (const double side : {-0.05, 0.05}) in_view.push_back(all.positions[node] + Vec3::Constant(side));
  FramingOptions framing;
  framing.aspect = double(tile_width) / tile_height;
  RenderOptions options;
  options.width = 2 * tile_width, options.height = 2 * tile_height;
  const Tile tile{draw(simulation, state.time, state.x, frame_camera(in_view, framing), options), fmt::format("t = {:.4f} s", state.time)};
  write_contact_sheet(folder / "place.png", std::span(&tile, 1), "Where cloth could not be kept apart");
  return folder;
}

void draw_contact_sheet(const Simulation& simulation, const ResultsFolder& results) {
  const Scene& scene = simulation.scene();
  const std::vector<int> frames = chosen_frames(results.frame_count());
  if (frames.empty()) throw InputError({results.folder().string()}, "holds no frames; run a scene into it first");
  const double frame_time = scene.time.step * scene.time.steps_per_frame;

  std::vector<std::vector<Vec3>> positions;
  std::vector<Vec3> in_view;
  for (const int frame : frames) {
    positions.push_back(results.read_frame(frame));
    in_view.insert(in_view.end(), positions.back().begin(), positions.back().end());
  }
  FramingOptions framing;
  framing.aspect = double(tile_width) / tile_height;
  const Camera camera = frame_camera(in_view, framing);

  RenderOptions options;
  options.width = tile_width;
  options.height = tile_height;
  std::vector<Tile> tiles;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const double time = frames[t] * frame_time;
    tiles.push_back({draw(simulation, time, positions[t], camera, options), fmt::format("t = {:.3f} s", time)});
  }
  write_contact_sheet(results.contact_sheet_file(), tiles, fmt::format("{}   ({} nodes)", scene.title, simulation.cloth().nodes()));
}

}  // namespace taut
