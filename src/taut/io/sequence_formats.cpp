#include "taut/io/sequence_formats.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <set>

#include "taut/base/error.h"

namespace taut {

namespace {

constexpr std::array<SequenceFormat, 7> formats{{
    {"usd", "USD: one .usda with a mesh a cloth and solid, points over time", UpAxis::z,
     detail::make_usd_sequence},
    {"obj", "OBJ: a file a frame and object", UpAxis::z, detail::make_obj_sequence},
    {"ply", "PLY, binary: a file a frame and object", UpAxis::z, detail::make_ply_sequence},
    {"pc2", "an OBJ and a PC2 point cache an object", UpAxis::z, detail::make_pc2_sequence},
    {"mdd", "an OBJ and an MDD point cache an object", UpAxis::z, detail::make_mdd_sequence},
    {"vtk", "VTK XML: a .vtp a frame and object with fields, and a .pvd for ParaView", UpAxis::z,
     detail::make_vtk_sequence},
    {"gltf", "glTF 2.0: one .glb animated by morph targets", UpAxis::y, detail::make_gltf_sequence},
}};

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

std::unique_ptr<SequenceWriter> make_sequence_writer(const SequenceFormat& format,
                                                     SequenceOptions options,
                                                     std::vector<SequenceObject> objects) {
  set_stems(objects);
  return format.make(std::move(options), std::move(objects));
}

TriangleMesh detail::mesh_at(const SequenceObject& object, const ObjectFrame& frame) {
  return {frame.points, object.triangles, object.texcoords};
}

}  // namespace taut
