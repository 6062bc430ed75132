// A .vtp (VTK XML PolyData, raw appended data) a frame and object, and sequence.pvd, which tells
// ParaView the time of each; what does not move has one .vtp, named at every time.
//
// Source: VTK File Formats, https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html.
#include <fmt/format.h>

#include <ostream>

#include "taut/base/file.h"
#include "taut/io/little_endian.h"
#include "taut/io/sequence_formats.h"

namespace taut::detail {

namespace {

// Arrays of a .vtp: their descriptions and, one after the other, their bytes.
class AppendedArrays {
 public:
  template <class T, class Numbers>
  std::string add(const char* type, const std::string& name, int components,
                  const Numbers& numbers) {
    const std::size_t offset = bytes_.size();
    append_little_endian(bytes_, std::uint64_t{0});
    for (const auto number : numbers) append_little_endian(bytes_, static_cast<T>(number));
    std::string length;
    append_little_endian(length, static_cast<std::uint64_t>(bytes_.size() - offset - 8));
    bytes_.replace(offset, 8, length);
    return fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"/>\n",
        type, name, components, offset);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::vector<double> flat_texcoords(const std::vector<Vec2>& texcoords) {
  std::vector<double> numbers;
  for (const Vec2& uv : texcoords) numbers.insert(numbers.end(), uv.begin(), uv.end());
  return numbers;
}

std::string point_data(const SequenceObject& object, const ObjectFrame& frame,
                       AppendedArrays& arrays) {
  std::string attributes, descriptions;
  for (const PointField& field : frame.fields) {
    const char* kind = field.components == 3 ? " Vectors" : " Scalars";
    if (attributes.find(kind) == std::string::npos)
      attributes += fmt::format("{}=\"{}\"", kind, field.name);
    descriptions += arrays.add<float>("Float32", field.name, field.components, field.values);
  }
  if (!object.texcoords.empty()) {
    attributes += " TCoords=\"st\"";
    descriptions += arrays.add<float>("Float32", "st", 2, flat_texcoords(object.texcoords));
  }
  return fmt::format("      <PointData{}>\n{}      </PointData>\n", attributes, descriptions);
}

std::string polygons(const SequenceObject& object, AppendedArrays& arrays) {
  std::vector<Index> corners, ends;
  for (const Triangle& t : object.triangles) {
    corners.insert(corners.end(), t.begin(), t.end());
    ends.push_back(static_cast<Index>(corners.size()));
  }
  return arrays.add<std::int32_t>("Int32", "connectivity", 1, corners) +
         arrays.add<std::int32_t>("Int32", "offsets", 1, ends);
}

void write_vtp(const std::filesystem::path& path, const SequenceObject& object,
               const ObjectFrame& frame, double time) {
  AppendedArrays arrays;
  const std::string fields = point_data(object, frame, arrays);
  const std::string points = arrays.add<float>("Float32", "points", 3, flat(frame.points));
  const std::string polys = polygons(object, arrays);
  write_file(path, [&](std::ostream& out) {
    out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
           "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  "
           "<PolyData>\n"
        << "    <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" "
           "NumberOfTuples=\"1\" format=\"ascii\">"
        << fmt::format("{}</DataArray>\n    </FieldData>\n", time)
        << fmt::format(
               "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
               "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
               object.points, object.triangles.size())
        << fields << "      <Points>\n"
        << points << "      </Points>\n      <Polys>\n"
        << polys << "      </Polys>\n    </Piece>\n  </PolyData>\n"
        << "  <AppendedData encoding=\"raw\">\n_" << arrays.bytes()
        << "\n  </AppendedData>\n</VTKFile>\n";
  });
}

// As the value of an attribute.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text)
    result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return result;
}

class VtkSequence : public SequenceWriter {
 public:
  using SequenceWriter::SequenceWriter;

  void finish() override {
    write_file(options().main_file("sequence.pvd"),
               "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
               "byte_order=\"LittleEndian\">\n  <Collection>\n" +
                   entries_ + "  </Collection>\n</VTKFile>\n");
  }

 private:
  void write_frame(int number, std::span<const ObjectFrame> frame) override {
    const double time = time_of(number);
    for (std::size_t k = 0; k < frame.size(); ++k) {
      const SequenceObject& object = objects()[k];
      const std::string name =
          object.moves ? fmt::format("{}_{:06}.vtp", object.stem, number) : object.stem + ".vtp";
      if (object.moves || is_first()) write_vtp(file(name), object, frame[k], time);
      entries_ +=
          fmt::format("    <DataSet timestep=\"{}\" group=\"{}\" part=\"{}\" file=\"{}\"/>\n", time,
                      escaped(object.stem), k, escaped(name));
    }
  }

  std::string entries_;
};

}  // namespace

std::unique_ptr<SequenceWriter> make_vtk_sequence(SequenceOptions options,
                                                  std::vector<SequenceObject> objects) {
  return std::make_unique<VtkSequence>(std::move(options), std::move(objects));
}

}  // namespace taut::detail
