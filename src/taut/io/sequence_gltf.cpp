// sequence.glb: glTF 2.0 in one binary file. The first frame is the mesh; each later frame is a
// morph target, its points' displacements from there. An animation fades linearly from one target
// to the next. What does not move is a mesh without targets.
//
//   weights   at frame k: 1 for target k, 0 for all others: frames x targets numbers for each
//             object
//   (u, v)    glTF counts v from the top: 1 - v is written
//
// Source: Khronos Group, "glTF 2.0 Specification", 3.6.2 (accessors), 3.7.2.2 (morph targets), 3.11
// (animations), 4.4 (GLB).
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/io/little_endian.h"
#include "taut/io/sequence_formats.h"
#include "taut/io/spool_file.h"

namespace taut::detail {

namespace {

using Json = nlohmann::ordered_json;

constexpr int float_type = 5126, uint_type = 5125, array_buffer = 34962,
              element_array_buffer = 34963;
// Viewers load the whole file into memory, and the format itself ends at 4 GiB.
constexpr double most_bytes = 512.0 * 1024 * 1024;

double bytes_of(const SequenceObject& object, double frames) {
  const double mesh =
      object.points * (3 + 2) * 4.0 + static_cast<double>(object.triangles.size()) * 12.0;
  return object.moves ? mesh + (frames - 1) * (object.points * 12.0 + frames * 4.0) : mesh;
}

void check_size(const SequenceOptions& options, const std::vector<SequenceObject>& objects) {
  double bytes = 0;
  for (const SequenceObject& object : objects) bytes += bytes_of(object, options.frames);
  if (bytes <= most_bytes) return;
  throw InputError(
      {options.main_file("sequence.glb").string()},
      fmt::format("would have {:.0f} MiB for {} frames, more than the {:.0f} MiB that programs "
                  "open; export every tenth frame or "
                  "so (--frames FIRST:LAST:STEP), or use the format usd, which has no such limit",
                  bytes / 1048576, options.frames, most_bytes / 1048576));
}

class GltfSequence : public SequenceWriter {
 public:
  GltfSequence(SequenceOptions options, std::vector<SequenceObject> objects)
      : SequenceWriter(std::move(options), std::move(objects)), bytes_(this->options().folder) {}

  void finish() override {
    Json animation = {{"samplers", Json::array()}, {"channels", Json::array()}};
    const int times = frames_added() > 1 ? add_times() : -1;
    Json meshes = Json::array(), nodes = Json::array(), scene_nodes = Json::array();
    for (std::size_t k = 0; k < meshes_.size(); ++k) {
      const SequenceObject& object = objects()[k];
      meshes.push_back(mesh_json(object, meshes_[k]));
      nodes.push_back({{"name", object.stem}, {"mesh", k}});
      scene_nodes.push_back(k);
      if (meshes_[k].targets.empty()) continue;
      animation["channels"].push_back({{"sampler", animation["samplers"].size()},
                                       {"target", {{"node", k}, {"path", "weights"}}}});
      animation["samplers"].push_back(
          {{"input", times}, {"output", add_weights()}, {"interpolation", "LINEAR"}});
    }
    Json gltf = {{"asset", {{"version", "2.0"}, {"generator", "Taut " TAUT_VERSION}}},
                 {"scene", 0},
                 {"scenes", Json::array({{{"nodes", scene_nodes}}})},
                 {"nodes", nodes},
                 {"meshes", meshes},
                 {"materials", materials()},
                 {"accessors", accessors_},
                 {"bufferViews", views_},
                 {"buffers", Json::array({{{"byteLength", bytes_.size()}}})}};
    if (!options().title.empty()) gltf["scenes"][0]["name"] = options().title;
    if (!animation["channels"].empty()) gltf["animations"] = Json::array({animation});
    write_glb(gltf);
  }

 private:
  struct Mesh {
    int positions = -1, indices = -1, texcoords = -1;
    std::vector<int> targets;
    std::vector<Vec3> base;
  };

  int add_accessor(const std::string& bytes, int component_type, const char* type,
                   std::size_t count, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
    if (target) view["target"] = target;
    bytes_.append(bytes);
    accessors_.push_back({{"bufferView", views_.size()},
                          {"componentType", component_type},
                          {"count", count},
                          {"type", type}});
    views_.push_back(std::move(view));
    return static_cast<int>(accessors_.size()) - 1;
  }

  // With their bounds, which glTF asks for.
  int add_vectors(const std::vector<Vec3>& vectors) {
    std::string bytes;
    Eigen::Vector3f low = Eigen::Vector3f::Zero(), high = low;
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      const Eigen::Vector3f v = vectors[i].cast<float>();
      low = i == 0 ? v : Eigen::Vector3f(low.cwiseMin(v));
      high = i == 0 ? v : Eigen::Vector3f(high.cwiseMax(v));
      for (const float x : v) append_little_endian(bytes, x);
    }
    const int accessor = add_accessor(bytes, float_type, "VEC3", vectors.size(), array_buffer);
    accessors_.back()["min"] = std::vector<float>(low.begin(), low.end());
    accessors_.back()["max"] = std::vector<float>(high.begin(), high.end());
    return accessor;
  }

  void write_frame(int number, std::span<const ObjectFrame> frame) override {
    if (is_first())
      for (std::size_t k = 0; k < frame.size(); ++k) add_mesh(objects()[k], frame[k]);
    times_.push_back(static_cast<float>(time_of(number) - time_of(options().first_frame)));
    if (is_first()) return;
    for (std::size_t k = 0; k < frame.size(); ++k) {
      if (!objects()[k].moves) continue;
      std::vector<Vec3> displacements(frame[k].points);
      for (std::size_t i = 0; i < displacements.size(); ++i) displacements[i] -= meshes_[k].base[i];
      meshes_[k].targets.push_back(add_vectors(displacements));
    }
  }

  void add_mesh(const SequenceObject& object, const ObjectFrame& frame) {
    Mesh mesh;
    mesh.positions = add_vectors(frame.points);
    std::string indices, texcoords;
    for (const Triangle& t : object.triangles)
      for (const Index vertex : t)
        append_little_endian(indices, static_cast<std::uint32_t>(vertex));
    mesh.indices = add_accessor(indices, uint_type, "SCALAR", 3 * object.triangles.size(),
                                element_array_buffer);
    for (const Vec2& uv : object.texcoords)
      for (const double c : {uv.x(), 1.0 - uv.y()})
        append_little_endian(texcoords, static_cast<float>(c));
    if (!texcoords.empty())
      mesh.texcoords =
          add_accessor(texcoords, float_type, "VEC2", object.texcoords.size(), array_buffer);
    mesh.base = frame.points;
    meshes_.push_back(std::move(mesh));
  }

  int add_times() {
    std::string bytes;
    for (const float time : times_) append_little_endian(bytes, time);
    const int accessor = add_accessor(bytes, float_type, "SCALAR", times_.size(), 0);
    accessors_.back()["min"] = Json::array({times_.front()});
    accessors_.back()["max"] = Json::array({times_.back()});
    return accessor;
  }

  // The same for every object that moves: written once.
  int add_weights() {
    if (weights_ >= 0) return weights_;
    std::string bytes;
    for (std::size_t frame = 0; frame < times_.size(); ++frame)
      for (std::size_t target = 1; target < times_.size(); ++target)
        append_little_endian(bytes, target == frame ? 1.0F : 0.0F);
    return weights_ =
               add_accessor(bytes, float_type, "SCALAR", times_.size() * (times_.size() - 1), 0);
  }

  static Json mesh_json(const SequenceObject& object, const Mesh& mesh) {
    Json attributes = {{"POSITION", mesh.positions}};
    if (mesh.texcoords >= 0) attributes["TEXCOORD_0"] = mesh.texcoords;
    Json primitive = {{"attributes", attributes},
                      {"indices", mesh.indices},
                      {"material", object.is_cloth ? 0 : 1}};
    for (const int target : mesh.targets) primitive["targets"].push_back({{"POSITION", target}});
    Json json = {{"name", object.stem}, {"primitives", Json::array({primitive})}};
    if (!mesh.targets.empty()) json["weights"] = std::vector<int>(mesh.targets.size(), 0);
    return json;
  }

  static Json materials() {
    const auto material = [](const char* name, std::vector<double> colour, bool double_sided) {
      return Json{{"name", name},
                  {"pbrMetallicRoughness",
                   {{"baseColorFactor", std::move(colour)},
                    {"metallicFactor", 0.0},
                    {"roughnessFactor", 0.8}}},
                  {"doubleSided", double_sided}};
    };
    return Json::array({material("cloth", {0.04, 0.19, 0.51, 1.0}, true),
                        material("solid", {0.57, 0.55, 0.52, 1.0}, false)});
  }

  void write_glb(const Json& gltf) {
    std::string json = gltf.dump();
    json.append((4 - json.size() % 4) % 4, ' ');
    // a multiple of 4: all arrays are
    const auto data_size = static_cast<std::uint32_t>(bytes_.size());
    std::string head = "glTF", data_head;
    append_little_endian(head, std::uint32_t{2});
    append_little_endian(head, static_cast<std::uint32_t>(12 + 8 + json.size() + 8) + data_size);
    append_little_endian(head, static_cast<std::uint32_t>(json.size()));
    append_little_endian(data_head, data_size);
    write_file(options().main_file("sequence.glb"), [&](std::ostream& out) {
      out << head << "JSON" << json << data_head << std::string_view("BIN\0", 4);
      bytes_.copy_to(out);
    });
  }

  SpoolFile bytes_;
  Json accessors_ = Json::array(), views_ = Json::array();
  std::vector<Mesh> meshes_;
  std::vector<float> times_;
  int weights_ = -1;
};

}  // namespace

std::unique_ptr<SequenceWriter> make_gltf_sequence(SequenceOptions options,
                                                   std::vector<SequenceObject> objects) {
  check_size(options, objects);
  return std::make_unique<GltfSequence>(std::move(options), std::move(objects));
}

}  // namespace taut::detail
