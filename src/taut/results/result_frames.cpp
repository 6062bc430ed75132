#include "taut/results/result_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/scene/scene_file.h"
#include "taut/scene/scene_world.h"
#include "taut/sim/cloth_model.h"

namespace taut {

namespace {

Scene scene_of(const ResultsFolder& results) {
  if (!std::filesystem::exists(results.scene_file()))
    throw InputError({results.folder().string()},
                     "holds no scene.toml: it is no result of `taut run`");
  return read_scene(results.scene_file());
}

double size_of(const Solid& solid) {
  switch (solid.shape) {
    case SolidShape::sphere:
      return solid.radius;
    case SolidShape::cylinder:
      return std::max(solid.radius, solid.height);
    case SolidShape::box:
      return solid.size.maxCoeff();
    case SolidShape::plane:
    case SolidShape::mesh:
      break;
  }
  return 0.0;
}

std::vector<double> node_stretch(const ClothModel& cloth, std::span<const Vec3> x) {
  std::vector<double> stretch(x.size(), 0.0);
  std::vector<bool> known(x.size(), false);
  for (const SpringModel* model : cloth.stretch_springs()) {
    const std::vector<double> strains = spring_strains(*model, x);
    for (std::size_t s = 0; s < strains.size(); ++s)
      for (const Index node : {model->springs()[s].i, model->springs()[s].j}) {
        const auto n = static_cast<std::size_t>(node);
        stretch[n] = known[n] ? std::max(stretch[n], strains[s]) : strains[s];
        known[n] = true;
      }
  }
  return stretch;
}

std::vector<double> nearness(std::span<const SolidEntry> solids, double time,
                             std::span<const Vec3> x) {
  std::vector<double> contact(x.size(), 0.0);
  for (const Solid& solid : solids) {
    if (solid.shape == SolidShape::mesh) continue;
    const Pose pose = solid.pose(time);
    const double reach = solid.thickness + 1e-4 + 2e-4 * size_of(solid);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (closest_surface(solid, pose.to_local(x[i])).distance <= reach) contact[i] = 1.0;
  }
  return contact;
}

}  // namespace

ResultFrames::ResultFrames(const std::filesystem::path& folder)
    : results_(folder), scene_(scene_of(results_)), cloth_(make_world(scene_).world) {}

int ResultFrames::last_frame() const {
  const int count = results_.frame_count();
  if (count == 0) throw InputError({results_.folder().string()}, "holds no frames yet");
  return count - 1;
}

bool ResultFrames::run_has_finished() const {
  if (!std::filesystem::exists(results_.summary_file())) return false;
  const nlohmann::json summary =
      nlohmann::json::parse(read_file(results_.summary_file()), nullptr, false);
  return summary.is_object() && summary.value("status", std::string()) == "finished";
}

std::vector<Vec3> ResultFrames::positions(int frame) const {
  std::vector<Vec3> x = results_.read_frame(frame);
  if (static_cast<Index>(x.size()) != cloth_.nodes())
    throw InputError({results_.frame_file(frame).string()},
                     fmt::format("has {} nodes, the scene has {}", x.size(), cloth_.nodes()));
  return x;
}

std::vector<double> ResultFrames::contact(int frame, std::span<const Vec3> x) const {
  const std::optional<std::vector<std::uint8_t>> recorded = results_.read_contact(frame);
  if (!recorded) return nearness(scene_.solids, time_of(frame), x);
  if (recorded->size() != x.size())
    throw InputError({results_.contact_file(frame).string()},
                     fmt::format("has {} nodes, the scene has {}", recorded->size(), x.size()));
  return {recorded->begin(), recorded->end()};
}

NodeFields ResultFrames::fields(int frame, std::span<const Vec3> x) const {
  NodeFields fields;
  fields.velocity = cloth_.start().v;
  if (frame > 0) {
    const std::vector<Vec3> before = positions(frame - 1);
    for (std::size_t i = 0; i < before.size(); ++i)
      fields.velocity[i] = (x[i] - before[i]) / interval();
  }
  fields.stretch = node_stretch(cloth_, x);
  fields.contact = contact(frame, x);
  return fields;
}

}  // namespace taut
