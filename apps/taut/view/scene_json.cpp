#include "view/scene_json.h"

#include <cmath>

#include "taut/base/error.h"
#include "taut/scene/scene_file.h"

namespace taut::app {

namespace {

using Json = nlohmann::ordered_json;

const char* name_of(SolidShape shape) {
  switch (shape) {
    case SolidShape::sphere:
      return "sphere";
    case SolidShape::plane:
      return "plane";
    case SolidShape::cylinder:
      return "cylinder";
    case SolidShape::box:
      return "box";
    case SolidShape::mesh:
      return "mesh";
  }
  return "unknown";
}

// Seven digits are enough to draw, and short as text.
double rounded(double value) {
  if (value == 0.0 || !std::isfinite(value)) return 0.0;
  const double scale = std::pow(10.0, 6.0 - std::floor(std::log10(std::abs(value))));
  return std::isfinite(scale) ? std::round(value * scale) / scale : 0.0;
}

Json pose_json(const Pose& pose) {
  const auto& t = pose.translation;
  const auto& q = pose.rotation;
  Json numbers = Json::array();
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()})
    numbers.push_back(rounded(value));
  return numbers;
}

bool moves(const Solid& solid) {
  return solid.key_frames.size() > 1 || solid.velocity.norm() > 0.0 ||
         solid.angular_velocity.norm() > 0.0;
}

Json solid_json(const Solid& solid, const TimeOptions& time) {
  Json poses = Json::array();
  const int count = moves(solid) ? time.frames + 1 : 1;
  for (int frame = 0; frame < count; ++frame)
    poses.push_back(pose_json(solid.pose(frame * time.steps_per_frame * time.step)));
  return {{"name", solid.name},
          {"shape", name_of(solid.shape)},
          {"radius", solid.radius},
          {"height", solid.height},
          {"size", {solid.size.x(), solid.size.y(), solid.size.z()}},
          {"thickness", solid.thickness},
          {"poses", std::move(poses)}};
}

void add_scene(Json& json, const ResultFiles& files) try {
  const auto file = files.open("scene.toml");
  if (!file) throw InputError({(files.folder() / "scene.toml").string()}, "is not there");
  const Scene scene = read_scene_text(file->read(0, file->size()), files.folder() / "scene.toml");
  json["title"] = scene.title;
  json["frame_s"] = scene.time.step * scene.time.steps_per_frame;
  json["frames_expected"] = scene.time.frames + 1;
  for (const Solid& solid : scene.solids) json["solids"].push_back(solid_json(solid, scene.time));
} catch (const InputError& error) {
  json["note"] = std::string("Without solids, at 25 frames a second: ") + error.what();
}

Json cloths_json(const ResultFiles& files, std::int64_t nodes, std::int64_t triangles) {
  if (const auto file = files.open_in_frames("cloths.json")) {
    Json cloths = Json::parse(file->read(0, file->size()), nullptr, false);
    if (cloths.is_array()) return cloths;
  }
  return {{{"name", "cloth"},
           {"first_node", 0},
           {"nodes", nodes},
           {"first_triangle", 0},
           {"triangles", triangles}}};
}

// Whether the run records what touches each node. What is damaged is told when it is asked for.
bool has_contact(const ResultFiles& files, std::int64_t nodes) try {
  const auto first = files.open_contact(0);
  return first && first->header.shape[0] == nodes;
} catch (const InputError&) {
  return false;
}

std::int64_t rows(const std::optional<ArrayFile>& array) {
  return array ? array->header.shape[0] : 0;
}

}  // namespace

Json scene_json(const ResultFiles& files) {
  const auto triangles = files.open_array("triangles.npy", "<i4", 3);
  const auto start = files.open_frame(0);
  if (!triangles || !start) throw InputError({files.folder().string()}, "has no frame yet");
  const auto uv = files.open_array("uv.npy", "<f4", 2);
  const auto springs = files.open_array("stretch_springs.npy", "<i4", 2);
  const auto rest = files.open_array("rest_lengths.npy", "<f4", 1);
  Json json{{"title", ""},
            {"folder", std::filesystem::weakly_canonical(files.folder()).filename().string()},
            {"nodes", rows(start)},
            {"triangles", rows(triangles)},
            {"springs", rows(springs) == rows(rest) ? rows(springs) : 0},
            {"uv", rows(uv) == rows(start)},
            {"contact", has_contact(files, rows(start))},
            {"frame_s", 0.04},
            {"frames_expected", nullptr},
            {"cloths", cloths_json(files, rows(start), rows(triangles))},
            {"solids", Json::array()},
            {"note", ""}};
  add_scene(json, files);
  return json;
}

}  // namespace taut::app
