#include "taut/io/sequence_formats.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>
#include <set>

#include "taut/base/error.h"

namespace taut {

namespace {

constexpr std::array<SequenceFormat, 7> formats{{
    {"usd", "USD: one .usda with a mesh a cloth and solid, points over time", ".usda .usd", true,
     UpAxis::z, detail::make_usd_sequence},
    {"obj", "OBJ: a file a frame and object", ".obj", false, UpAxis::z, detail::make_obj_sequence},
    {"ply", "PLY, binary: a file a frame and object", ".ply", false, UpAxis::z,
     detail::make_ply_sequence},
    {"pc2", "an OBJ and a PC2 point cache an object", ".pc2", false, UpAxis::z,
     detail::make_pc2_sequence},
    {"mdd", "an OBJ and an MDD point cache an object", ".mdd", false, UpAxis::z,
     detail::make_mdd_sequence},
    {"vtk", "VTK XML: a .vtp a frame and object with fields, and a .pvd for ParaView", ".pvd",
     false, UpAxis::z, detail::make_vtk_sequence},
    {"gltf", "glTF 2.0: one .glb animated by morph targets", ".glb", true, UpAxis::y,
     detail::make_gltf_sequence},
}};

struct SisterFile {
  std::string_view ending, instead;
};
constexpr SisterFile sisters[] = {{".usdc", "USD is written as text: .usda"},
                                  {".usdz", "USD is written as text: .usda"},
                                  {".gltf", "glTF is written in one binary file: .glb"},
                                  {".vtp", "ParaView's list of all frames is the .pvd: .pvd"},
                                  {".vtk", "ParaView's list of all frames is the .pvd: .pvd"},
                                  {".vtu", "ParaView's list of all frames is the .pvd: .pvd"}};

// Letters, digits and _, beginning with no digit: a name in every format.
std::string plain_name(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'),
               digit = c >= '0' && c <= '9';
    plain += letter || digit ? c : '_';
  }
  if (plain.empty() || (plain[0] >= '0' && plain[0] <= '9')) plain.insert(plain.begin(), '_');
  return plain;
}

// One object needs no name beside the file's.
void put_in_front(const std::string& file_name, std::vector<SequenceObject>& objects) {
  const std::string front = std::filesystem::path(file_name).stem().string();
  for (SequenceObject& object : objects)
    object.stem = objects.size() == 1 ? front : front + "_" + object.stem;
}

void set_stems(std::vector<SequenceObject>& objects) {
  std::set<std::string> taken;
  for (SequenceObject& object : objects) {
    object.stem = plain_name(object.name);
    for (int n = 2; !taken.insert(object.stem).second; ++n)
      object.stem = plain_name(object.name) + "_" + std::to_string(n);
  }
}

}  // namespace

void SequenceWriter::add_frame(int number, std::span<const ObjectFrame> frame) {
  assert(frame.size() == objects_.size());
  write_frame(number, frame);
  ++frames_added_;
}

std::span<const SequenceFormat> sequence_formats() { return formats; }

const SequenceFormat& sequence_format(const std::string& name) {
  const auto* const found = std::find_if(formats.begin(), formats.end(),
                                         [&](const SequenceFormat& f) { return f.name == name; });
  if (found != formats.end()) return *found;
  std::string names;
  for (const SequenceFormat& format : formats)
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  throw InputError("there is no format '" + name + "'; one of these was expected: " + names);
}

const SequenceFormat* sequence_format_of(const std::filesystem::path& file_name) {
  std::string ending = file_name.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending.empty()) return nullptr;
  for (const SequenceFormat& format : formats)
    if ((std::string(" ") + format.endings + " ").find(" " + ending + " ") != std::string::npos)
      return &format;
  for (const SisterFile& sister : sisters)
    if (ending == sister.ending)
      throw InputError({file_name.string()}, "files ending in " + ending + " are not written; " +
                                                 std::string(sister.instead));
  return nullptr;
}

std::unique_ptr<SequenceWriter> make_sequence_writer(const SequenceFormat& format,
                                                     SequenceOptions options,
                                                     std::vector<SequenceObject> objects) {
  set_stems(objects);
  if (!format.is_one_file && !options.file_name.empty()) put_in_front(options.file_name, objects);
  return format.make(std::move(options), std::move(objects));
}

TriangleMesh detail::mesh_at(const SequenceObject& object, const ObjectFrame& frame) {
  return {frame.points, object.triangles, object.texcoords};
}

}  // namespace taut
