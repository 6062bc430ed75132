#include <fmt/format.h>

#include "taut/io/obj.h"
#include "taut/picture/contact_sheet.h"
#include "taut/results/frame_picture.h"
#include "taut/results/run.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/surface_contact.h"
#include "taut/step/state.h"

namespace taut {

std::filesystem::path save_last_good(const SceneSimulation& simulation,
                                     const ResultsFolder& results) {
  constexpr int width = 960, height = 800;
  constexpr double around = 0.05;  // m, in view about each node that could not be kept apart
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
    for (const double side : {-around, around})
      in_view.push_back(all.positions[node] + Vec3::Constant(side));
  FramingOptions framing;
  framing.aspect = double(width) / height;
  RenderOptions options;
  options.width = width, options.height = height;
  const SolidShapes solids(simulation.scene());
  const Tile tile{draw_scene(simulation.cloth(), state.x, solids, state.time,
                             frame_camera(in_view, framing), options),
                  fmt::format("t = {:.4f} s", state.time)};
  write_contact_sheet(folder / "place.png", std::span(&tile, 1),
                      "Where cloth could not be kept apart");
  return folder;
}

}  // namespace taut
