#include "taut/results/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/base/file_lock.h"
#include "taut/io/npy.h"
#include "taut/io/sequence_writer.h"
#include "taut/results/checkpoint.h"
#include "taut/results/solid_shapes.h"
#include "taut/scene/scene_file.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/simulation_state.h"

namespace taut {

namespace fs = std::filesystem;

namespace {

// What a run may leave in its folder; anything else there belongs to somebody.
constexpr const char* own_names[] = {"scene.toml",   "frames",     "stats.csv",
                                     "summary.json", "checkpoint", "contact_sheet.png",
                                     "stats.svg",    "last_good"};

void refuse_foreign_folder(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder))
    throw InputError({folder.string()}, "is a file; give a folder for the results with --out");
  if (fs::is_empty(folder) || fs::exists(folder / "scene.toml")) return;
  throw InputError(
      {folder.string()},
      "holds files but no earlier result (no scene.toml); give an empty or new folder with --out");
}

std::string cloths_json(const ClothModel& cloth) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ClothPart& part : cloth.parts())
    list.push_back({{"name", part.name},
                    {"first_node", part.first_node},
                    {"nodes", part.node_count},
                    {"first_triangle", part.first_triangle},
                    {"triangles", part.triangle_count}});
  return list.dump(2) + "\n";
}

void write_stretch_springs(const ClothModel& cloth, const fs::path& folder) {
  std::vector<std::int32_t> ends;
  std::vector<float> lengths;
  for (const SpringModel* model : cloth.stretch_springs())
    for (const Spring& spring : model->springs()) {
      ends.insert(ends.end(), {spring.i, spring.j});
      lengths.push_back(static_cast<float>(spring.parameters.rest_length));
    }
  const auto count = static_cast<std::int64_t>(lengths.size());
  write_npy<std::int32_t>(folder / "stretch_springs.npy", ends, std::array{count, std::int64_t{2}});
  write_npy<float>(folder / "rest_lengths.npy", lengths, std::array{count});
}

std::vector<float> points_of(const TriangleMesh& mesh, std::size_t vertices) {
  std::vector<float> points;
  points.reserve(3 * vertices);
  for (const Vec3& x : std::span(mesh.positions).first(vertices))
    for (const double value : x) points.push_back(static_cast<float>(value));
  return points;
}

// Where the vertices of a solid that is a mesh are at each frame, or once if it never moves. All
// frames together may not fit into memory.
void write_solid_points(const fs::path& path, const SolidShapes& shapes, std::size_t solid,
                        std::size_t vertices, const TimeOptions& time) {
  const std::int64_t samples = shapes.moves(solid) ? time.frames + 1 : 1;
  std::vector<float> points;
  int frame = 0;
  write_npy<float>(
      path, std::array{samples * static_cast<std::int64_t>(vertices), std::int64_t{3}},
      [&]() -> std::span<const float> {
        points =
            points_of(shapes.at(solid, frame++ * time.steps_per_frame * time.step).mesh, vertices);
        return points;
      });
}

void write_mesh_solids(const Scene& scene, const fs::path& folder) {
  const auto is_mesh = [](const Solid& solid) { return solid.shape == SolidShape::mesh; };
  if (std::ranges::none_of(scene.solids, is_mesh)) return;
  const SolidShapes shapes(scene);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    if (!is_mesh(shapes.solid(k))) continue;
    std::vector<std::int32_t> triangles;
    // those that triangles use: readers take their number from the triangles
    std::int32_t vertices = 0;
    for (const Triangle& t : shapes.at(k, 0.0).mesh.triangles)
      for (const Index vertex : t)
        triangles.push_back(vertex), vertices = std::max(vertices, vertex + 1);
    write_npy<std::int32_t>(
        folder / fmt::format("solid_{}_triangles.npy", k), triangles,
        std::array{static_cast<std::int64_t>(triangles.size() / 3), std::int64_t{3}});
    write_solid_points(folder / fmt::format("solid_{}_points.npy", k), shapes, k,
                       static_cast<std::size_t>(vertices), scene.time);
  }
}

std::vector<std::string> replaced_by(const std::string& scene, const ResultsFolder& results) {
  std::vector<std::string> said;
  const fs::path& folder = results.folder();
  if (!fs::exists(results.scene_file())) return said;
  const std::string before = read_file(results.scene_file());
  if (before == scene) return said;
  const auto title = [](const std::string& text) {
    constexpr std::string_view key = "title = ";
    return text.starts_with(key) ? text.substr(key.size(), text.find('\n') - key.size())
                                 : std::string("without a title");
  };
  said.push_back(fmt::format(
      "{} held the result of another scene or of other settings ({}, {} frames); it is replaced",
      folder.string(), title(before), results.frame_count()));
  for (const SequenceFormat& format : sequence_formats())
    if (fs::is_directory(folder / format.name))
      said.push_back(fmt::format(
          "{} holds an export of the result that is replaced; export anew, or remove it",
          (folder / format.name).string()));
  return said;
}

// "NAME.tmp1234", as write_file leaves it when the process is killed.
void remove_unfinished_in(const fs::path& folder,
                          const std::function<bool(const std::string& name)>& ours) {
  std::vector<fs::path> left;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const std::size_t mark = name.rfind(".tmp");
    const bool numbered = mark != std::string::npos && mark + 4 < name.size() &&
                          name.find_first_not_of("0123456789", mark + 4) == std::string::npos;
    if (numbered && ours(name.substr(0, mark))) left.push_back(entry.path());
  }
  for (const fs::path& file : left) fs::remove(file);
}

std::vector<std::uint64_t> sums_of(std::span<const InputFile> files) {
  std::vector<std::uint64_t> sums;
  for (const InputFile& file : files) sums.push_back(file.sum);
  return sums;
}

// A scene's text but for the line that says how many frames there shall be.
std::string without_length(const std::string& scene) {
  constexpr std::string_view key = "\nframes = ";
  const std::size_t begin = scene.find(key);
  if (begin == std::string::npos) return scene;
  return scene.substr(0, begin) + scene.substr(scene.find('\n', begin + 1));
}

}  // namespace

fs::path ResultsFolder::frame_file(int frame) const {
  return folder_ / "frames" / fmt::format("{:06}.npy", frame);
}

fs::path ResultsFolder::contact_file(int frame) const {
  return folder_ / "frames" / fmt::format("contact_{:06}.npy", frame);
}

std::vector<std::string> ResultsFolder::start(const SceneSimulation& simulation) const {
  refuse_foreign_folder(folder_);
  refuse_running();
  const std::string scene = scene_to_toml(simulation.scene());
  std::vector<std::string> replaced = replaced_by(scene, *this);
  for (const char* name : own_names) fs::remove_all(folder_ / name);
  write_file(scene_file(), scene);
  const TriangleMesh& surface = simulation.cloth().surface();
  std::vector<std::int32_t> triangles;
  for (const Triangle& t : surface.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
  std::vector<float> uv;
  for (const Vec2& p : surface.texcoords)
    uv.insert(uv.end(), {static_cast<float>(p.x()), static_cast<float>(p.y())});
  const std::int64_t triangle_shape[] = {static_cast<std::int64_t>(surface.triangles.size()), 3},
                     uv_shape[] = {static_cast<std::int64_t>(surface.texcoords.size()), 2};
  write_npy<std::int32_t>(folder_ / "frames" / "triangles.npy", triangles, triangle_shape);
  write_npy<float>(folder_ / "frames" / "uv.npy", uv, uv_shape);
  write_stretch_springs(simulation.cloth(), folder_ / "frames");
  write_mesh_solids(simulation.scene(), folder_ / "frames");
  write_file(folder_ / "frames" / "cloths.json", cloths_json(simulation.cloth()));
  return replaced;
}

void ResultsFolder::change_length(const SceneSimulation& simulation) const {
  write_file(scene_file(), scene_to_toml(simulation.scene()));
  write_mesh_solids(simulation.scene(), folder_ / "frames");
}

void ResultsFolder::remove_unfinished() const {
  for (const fs::path& folder : {folder_ / "frames", folder_ / "checkpoint"})
    if (fs::exists(folder)) remove_unfinished_in(folder, [](const std::string&) { return true; });
  remove_unfinished_in(folder_, [](const std::string& name) {
    return std::ranges::find(own_names, name) != std::end(own_names);
  });
}

void ResultsFolder::refuse_running() const {
  if (is_being_written(stats_file()))
    throw InputError({folder_.string()},
                     "another taut is writing its results here; wait for its end, or give another "
                     "folder with --out");
}

void ResultsFolder::write_frame(int frame, std::span<const Vec3> x,
                                std::span<const std::uint8_t> contact) const {
  if (!contact.empty())
    write_npy<std::uint8_t>(contact_file(frame), contact,
                            std::array{static_cast<std::int64_t>(contact.size())});
  write_npy_float(frame_file(frame), x);
}

std::vector<Vec3> ResultsFolder::read_frame(int frame) const {
  return read_npy_nodes(frame_file(frame));
}

std::optional<std::vector<std::uint8_t>> ResultsFolder::read_contact(int frame) const {
  if (!fs::exists(contact_file(frame))) return {};
  return read_npy<std::uint8_t>(contact_file(frame)).values;
}

int ResultsFolder::frame_count() const {
  int count = 0;
  while (fs::exists(frame_file(count))) ++count;
  return count;
}

bool ResultsFolder::has_gap() const {
  const std::string missing = frame_file(frame_count()).filename().string();
  if (!fs::exists(folder_ / "frames")) return false;
  return std::ranges::any_of(fs::directory_iterator(folder_ / "frames"),
                             [&](const fs::directory_entry& entry) {
                               const std::string name = entry.path().filename().string();
                               return name.size() == missing.size() && name.ends_with(".npy") &&
                                      name.find_first_not_of("0123456789") == 6 && name > missing;
                             });
}

void ResultsFolder::remove_frames_after(int frame) const {
  for (int f = frame + 1; fs::exists(frame_file(f)); ++f) {
    fs::remove(frame_file(f));
    fs::remove(contact_file(f));
  }
}

void ResultsFolder::write_checkpoint(const SceneSimulation& simulation, int frame) const {
  const Checkpoint checkpoint{scene_to_toml(simulation.scene()), frame,
                              sums_of(simulation.input_files()), simulation.save()};
  write_file(checkpoint_file(), [&](std::ostream& out) { write(out, checkpoint); });
}

CheckpointPlace ResultsFolder::read_checkpoint(SceneSimulation& simulation) const {
  Checkpoint checkpoint =
      parse_checkpoint(read_file(checkpoint_file()), checkpoint_file().string());
  const SimulationState state = state_from(checkpoint.snapshot.bytes, checkpoint_file().string());
  const std::string scene = scene_to_toml(simulation.scene());
  if (without_length(checkpoint.scene) != without_length(scene))
    throw InputError(
        {checkpoint_file().string()},
        fmt::format("belongs to another scene than {}; run the scene anew with `taut run`",
                    scene_file().string()));
  const std::span<const InputFile> files = simulation.input_files();
  for (std::size_t k = 0; k < files.size() && checkpoint.files.size() == files.size(); ++k)
    if (checkpoint.files[k] != files[k].sum)
      throw InputError({files[k].path.string()},
                       fmt::format("has changed since {} was written; bring the old file back, or "
                                   "run the scene anew with `taut run`",
                                   checkpoint_file().string()));
  if (static_cast<Index>(state.state.x.size()) != simulation.cloth().nodes() ||
      checkpoint.files.size() != files.size())
    throw InputError({checkpoint_file().string()},
                     fmt::format("has {} nodes and {} mesh files, the scene has {} and {}: run the "
                                 "scene anew with `taut run`",
                                 state.state.x.size(), checkpoint.files.size(),
                                 simulation.cloth().nodes(), files.size()));
  try {
    simulation.set_full_state(state);
  } catch (const InputError& error) {
    throw InputError({checkpoint_file().string()},
                     std::string(error.what()) + "; run the scene anew with `taut run`");
  }
  return {checkpoint.frame, checkpoint.scene != scene};
}

std::string StatsWriter::header() {
  return "step,time,frame,nodes,dof,constraints,contacts,solver,core_springs,iterations,relative_"
         "residual,"
         "assemble_ms,order_ms,factor_ms,solve_ms,contact_ms,step_ms,kinetic_J,elastic_J,max_"
         "stretch,intersections,bound_iterations,"
         "precision,fallbacks,"
         "collapsed_springs,retries,zone_nodes,contact_passes,contact_moved,deepest_m,newton_"
         "iterations,"
         "pairs_tested,near_pairs,pushing_pairs,impacts,zones,largest_zone,near_ms,impulse_ms,"
         "detect_ms,zone_ms,check_ms,overshoot\n";
}

StatsWriter::StatsWriter(const fs::path& path, int keep_steps) : path_(path) {
  std::string content = header();
  if (keep_steps > 0) {
    content = read_file(path);
    std::size_t end = 0;
    for (int line = 0; line <= keep_steps; ++line) {
      end = content.find('\n', end);
      if (end == std::string::npos)
        throw InputError(
            {path.string()},
            fmt::format("has fewer than the {} steps of the checkpoint; run the scene anew",
                        keep_steps));
      ++end;
    }
    content.resize(end);
  }
  write_file(path, content);
  file_ = std::fopen(path.c_str(), "ab");
  if (!file_)
    throw InputError({path.string()}, "cannot be written; check the folder's permissions");
  mark_as_being_written(file_);
}

StatsWriter::~StatsWriter() { std::fclose(file_); }

void StatsWriter::write(const StepReport& r, int frame) {
  const auto optional = [](auto value, auto nothing) {
    return value == nothing ? std::string() : std::to_string(value);
  };
  const std::string row = fmt::format(
      "{},{:.9g},{},{},{},{},{},{},{},{},{:.3e},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.9g},{:"
      ".9g},{:.6g},{},{},{},{},{},{},{},{},{},{"
      ":.3e},{},{},{},{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3g}\n",
      r.step, r.time, frame, r.nodes, r.dof, r.constraints, r.contacts, r.solver,
      optional(r.core_springs, Index{0}), r.iterations, r.relative_residual, r.assemble_ms,
      r.order_ms, r.factor_ms, r.solve_ms, r.contact_ms, r.step_ms, r.kinetic_J, r.elastic_J,
      r.max_stretch, optional(r.intersections, -1), optional(r.bound_iterations, -1), r.precision,
      r.fallbacks, r.collapsed_springs, r.retries, r.zone_nodes, r.contact_passes, r.contact_moved,
      r.deepest_m, r.newton_iterations, r.pairs_tested, r.near_pairs, r.pushing_pairs, r.impacts,
      r.zones, r.largest_zone, r.near_ms, r.impulse_ms, r.detect_ms, r.zone_ms, r.check_ms,
      r.overshoot);
  // One write a row: a reader, or a crash, never sees half of one.
  if (std::fwrite(row.data(), 1, row.size(), file_) != row.size() || std::fflush(file_) != 0)
    throw InputError({path_.string()},
                     "cannot be written; is the disk full? The steps up to here are safe: `taut "
                     "resume` goes on");
}

}  // namespace taut
