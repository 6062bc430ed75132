#include "taut/results/sequence_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/error.h"
#include "taut/sim/cloth_model.h"

namespace taut {

namespace {

// Round enough to the eye, and a fifth of the data that pictures are drawn from.
constexpr int solid_segments = 48;

SequenceObject cloth_object(const ClothModel& cloth, const ClothPart& part) {
  SequenceObject object{.name = part.name,
                        .triangles = {},
                        .texcoords = {},
                        .points = part.node_count,
                        .moves = true,
                        .is_cloth = true,
                        .stem = {}};
  const TriangleMesh& surface = cloth.surface();
  object.texcoords.assign(surface.texcoords.begin() + part.first_node,
                          surface.texcoords.begin() + part.first_node + part.node_count);
  for (Index t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
    Triangle triangle = surface.triangles[static_cast<std::size_t>(t)];
    for (Index& node : triangle) node -= part.first_node;
    object.triangles.push_back(triangle);
  }
  return object;
}

SequenceObject solid_object(const SolidShapes& solids, std::size_t k) {
  const TriangleMesh mesh = solids.at(k, 0.0).mesh;
  return {.name = solids.name(k),
          .triangles = mesh.triangles,
          .texcoords = mesh.texcoords,
          .points = static_cast<Index>(mesh.positions.size()),
          .moves = solids.moves(k),
          .is_cloth = false,
          .stem = {}};
}

std::vector<SequenceObject> objects_of(const ResultFrames& frames, const SolidShapes& solids) {
  std::vector<SequenceObject> objects;
  for (const ClothPart& part : frames.cloth().parts())
    objects.push_back(cloth_object(frames.cloth(), part));
  for (std::size_t k = 0; k < solids.size(); ++k) objects.push_back(solid_object(solids, k));
  return objects;
}

void check(const SequenceExportOptions& o) {
  if (!(o.scale > 0.0) || !std::isfinite(o.scale))
    throw InputError(fmt::format("the scale is {}, a positive number was expected", o.scale));
  if (o.first < 0 || o.last < o.first || o.stride < 1)
    throw InputError(
        fmt::format("frames {} to {} in steps of {} are none; FIRST:LAST with 0 <= FIRST <= LAST "
                    "was expected, or FIRST:LAST:STEP",
                    o.first, o.last, o.stride));
}

template <class Values>
std::vector<double> part_of(const Values& values, const ClothPart& part) {
  return {values.begin() + part.first_node, values.begin() + part.first_node + part.node_count};
}

}  // namespace

SequenceExport::SequenceExport(const ResultFrames& frames, const SequenceExportOptions& options)
    : frames_(frames),
      solids_(frames.scene(), solid_segments),
      options_(options),
      up_(options.up.value_or(sequence_format(options.format).usual_up)),
      next_(options.first) {
  check(options);
  if (options.format == "gltf" && up_ != UpAxis::y)
    throw InputError("glTF files are Y-up by definition; leave out --up z");
  writer_ = make_sequence_writer(sequence_format(options.format),
                                 {.folder = options.folder,
                                  .file_name = options.file_name,
                                  .title = frames.scene().title,
                                  .first_frame = options.first,
                                  .frames = (options.last - options.first) / options.stride + 1,
                                  .frame_stride = options.stride,
                                  .frame_interval = frames.interval(),
                                  .up = up_,
                                  .metres_per_unit = 1.0 / options.scale},
                                 objects_of(frames, solids_));
}

std::vector<ObjectFrame> SequenceExport::objects_at(int frame) const {
  const std::vector<Vec3> x = frames_.positions(frame);
  const NodeFields fields = frames_.fields(frame, x);
  std::vector<ObjectFrame> objects;
  for (const ClothPart& part : frames_.cloth().parts()) {
    ObjectFrame object;
    PointField velocity{"velocity", 3, {}};
    for (Index i = part.first_node; i < part.first_node + part.node_count; ++i) {
      object.points.push_back(options_.scale * turned(x[static_cast<std::size_t>(i)]));
      const Vec3 v = options_.scale * turned(fields.velocity[static_cast<std::size_t>(i)]);
      velocity.values.insert(velocity.values.end(), v.begin(), v.end());
    }
    object.fields = {std::move(velocity),
                     {"stretch", 1, part_of(fields.stretch, part)},
                     {"contact", 1, part_of(fields.contact, part)}};
    objects.push_back(std::move(object));
  }
  for (std::size_t k = 0; k < solids_.size(); ++k) {
    ObjectFrame object;
    for (const Vec3& point : solids_.at(k, frames_.time_of(frame)).mesh.positions)
      object.points.push_back(options_.scale * turned(point));
    objects.push_back(std::move(object));
  }
  return objects;
}

void SequenceExport::add_frames_until(int frame) {
  for (; next_ <= std::min(frame, options_.last); next_ += options_.stride)
    writer_->add_frame(next_, objects_at(next_));
}

std::vector<std::filesystem::path> SequenceExport::files_of_other_frames() const {
  std::vector<std::filesystem::path> others;
  if (!std::filesystem::is_directory(options_.folder)) return others;
  const auto added = [&](int frame) {
    return frame >= options_.first && frame < next_ &&
           (frame - options_.first) % options_.stride == 0;
  };
  for (const auto& entry : std::filesystem::directory_iterator(options_.folder)) {
    const std::string name = entry.path().stem().string(),
                      extension = entry.path().extension().string();
    const std::size_t mark = name.rfind('_');
    if ((extension != ".obj" && extension != ".ply") || mark == std::string::npos ||
        name.size() - mark != 7 ||
        name.find_first_not_of("0123456789", mark + 1) != std::string::npos ||
        added(std::stoi(name.substr(mark + 1))))
      continue;
    const auto objects = writer_->objects();
    if (std::ranges::any_of(objects, [&](const SequenceObject& object) {
          return object.stem == name.substr(0, mark);
        }))
      others.push_back(entry.path());
  }
  return others;
}

std::string SequenceExport::written_to() const {
  if (options_.file_name.empty()) return options_.folder.string();
  const std::filesystem::path file = options_.folder / options_.file_name;
  if (std::filesystem::exists(file)) return file.lexically_normal().string();
  const std::string pattern = file.stem().string() + "_*" + file.extension().string();
  return (options_.folder / pattern).lexically_normal().string();
}

void SequenceExport::finish() {
  if (frames_added() > 0) writer_->finish();
}

}  // namespace taut
