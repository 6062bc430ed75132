// sequence.usda, or the name chosen: USD as text. One Mesh prim an object under /World; topology
// and texture coordinates once, points and extent at every frame, for what does not move once.
// The time code is the frame's number, timeCodesPerSecond makes seconds of it.
//
// Source: OpenUSD 24, "USD file format: text", schemas UsdGeomMesh, UsdGeomPointBased,
// UsdGeomGprim.
#include <Eigen/Geometry>
#include <ostream>

#include "taut/base/file.h"
#include "taut/io/sequence_formats.h"
#include "taut/io/shortest_decimal.h"
#include "taut/io/spool_file.h"

namespace taut::detail {

namespace {

constexpr const char* indent = "        ";

template <class Vector>
void append_tuple(std::string& text, const Vector& v) {
  for (Eigen::Index i = 0; i < v.size(); ++i)
    append_decimal(text += i == 0 ? "(" : ", ", static_cast<float>(v[i]));
  text += ')';
}

template <class Vector>
std::string array_of(const std::vector<Vector>& tuples) {
  std::string text = "[";
  for (const Vector& tuple : tuples) append_tuple(text += text.size() == 1 ? "" : ", ", tuple);
  return text += ']';
}

std::string array_of(const std::vector<Triangle>& triangles) {
  std::string text = "[";
  for (const Triangle& t : triangles)
    for (const Index vertex : t) (text += text.size() == 1 ? "" : ", ") += std::to_string(vertex);
  return text += ']';
}

std::string extent_of(const std::vector<Vec3>& points) {
  Eigen::AlignedBox3d box(Vec3::Zero());
  if (!points.empty()) box = Eigen::AlignedBox3d(points[0]);
  for (const Vec3& x : points) box.extend(x);
  return array_of(std::vector<Vec3>{box.min(), box.max()});
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' || c == '\r' ? ' ' : c;
  }
  return result + '"';
}

class UsdSequence : public SequenceWriter {
 public:
  using SequenceWriter::SequenceWriter;

  void finish() override {
    write_file(options().main_file("sequence.usda"), [&](std::ostream& out) {
      out << stage();
      for (std::size_t k = 0; k < prims_.size(); ++k) write_prim(out, objects()[k], prims_[k]);
      out << "}\n";
    });
  }

 private:
  struct Prim {
    std::string extents;                // a sample a frame, or the one value
    std::string points;                 // of what does not move
    std::unique_ptr<SpoolFile> frames;  // of what does
  };

  void write_frame(int number, std::span<const ObjectFrame> frame) override {
    if (is_first()) prims_.resize(frame.size());
    last_frame_ = number;
    const std::string time = std::string(indent) + "    " + std::to_string(number) + ": ";
    for (std::size_t k = 0; k < frame.size(); ++k) {
      Prim& prim = prims_[k];
      if (objects()[k].moves) {
        if (!prim.frames) prim.frames = std::make_unique<SpoolFile>(options().folder);
        prim.frames->append(time + array_of(frame[k].points) + ",\n");
        prim.extents += time + extent_of(frame[k].points) + ",\n";
      } else if (is_first()) {
        prim.points = array_of(frame[k].points);
        prim.extents = extent_of(frame[k].points);
      }
    }
  }

  std::string stage() const {
    const auto entry = [](const char* name, double value) {
      std::string line = std::string("    ") + name + " = ";
      append_decimal(line, value);
      return line + "\n";
    };
    const double rate = options().frame_interval > 0 ? 1.0 / options().frame_interval : 24.0;
    return "#usda 1.0\n(\n    defaultPrim = \"World\"\n    doc = " + quoted(options().title) +
           "\n" + entry("endTimeCode", last_frame_) + entry("framesPerSecond", rate) +
           entry("metersPerUnit", options().metres_per_unit) +
           entry("startTimeCode", options().first_frame) + entry("timeCodesPerSecond", rate) +
           "    upAxis = \"" + (options().up == UpAxis::y ? "Y" : "Z") +
           "\"\n)\n\ndef Xform \"World\" (\n    kind = \"component\"\n)\n{\n";
  }

  static void write_prim(std::ostream& out, const SequenceObject& object, Prim& prim) {
    out << "    def Mesh \"" << object.stem << "\"\n    {\n"
        << indent << "uniform bool doubleSided = " << (object.is_cloth ? 1 : 0) << '\n';
    const auto samples = [&](const char* name, const auto& write) {
      out << indent << name << ".timeSamples = {\n";
      write();
      out << indent << "}\n";
    };
    if (prim.frames)
      samples("float3[] extent", [&] { out << prim.extents; });
    else
      out << indent << "float3[] extent = " << prim.extents << '\n';
    std::string counts = "[";
    for (std::size_t t = 0; t < object.triangles.size(); ++t) counts += t == 0 ? "3" : ", 3";
    out << indent << "int[] faceVertexCounts = " << counts << "]\n"
        << indent << "int[] faceVertexIndices = " << array_of(object.triangles) << '\n';
    if (prim.frames)
      samples("point3f[] points", [&] { prim.frames->copy_to(out); });
    else
      out << indent << "point3f[] points = " << prim.points << '\n';
    out << indent << "color3f[] primvars:displayColor = ["
        << (object.is_cloth ? "(0.04, 0.19, 0.51)" : "(0.57, 0.55, 0.52)") << "]\n";
    if (!object.texcoords.empty())
      out << indent << "texCoord2f[] primvars:st = " << array_of(object.texcoords) << " (\n"
          << indent << "    interpolation = \"vertex\"\n"
          << indent << ")\n";
    out << indent << "uniform token subdivisionScheme = \"none\"\n    }\n";
  }

  std::vector<Prim> prims_;
  int last_frame_ = 0;
};

}  // namespace

std::unique_ptr<SequenceWriter> make_usd_sequence(SequenceOptions options,
                                                  std::vector<SequenceObject> objects) {
  return std::make_unique<UsdSequence>(std::move(options), std::move(objects));
}

}  // namespace taut::detail
