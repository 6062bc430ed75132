#include "taut/io/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "taut/base/error.h"
#include "taut/io/ply_data.h"
#include "taut/io/polygon_fan.h"
#include "taut/io/text_file.h"

namespace taut {

namespace {

using detail::PlyElement;
using detail::PlyProperty;

class PlyReader {
 public:
  PlyReader(std::string file, std::string_view bytes, std::vector<std::string>* notes)
      : file_(std::move(file)),
        header_(detail::parse_ply_header(file_, bytes)),
        data_(detail::make_ply_data(file_, bytes, header_)),
        notes_(notes) {}

  TriangleMesh read() {
    check_header();
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;  // takes no room, whatever its number
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else
        pass_over(element);
    }
    cut_faces();
    return std::move(mesh_);
  }

 private:
  const PlyElement* find(std::string_view name) const {
    const auto found = std::find_if(header_.elements.begin(), header_.elements.end(),
                                    [&](const PlyElement& e) { return e.name == name; });
    return found == header_.elements.end() ? nullptr : &*found;
  }

  void check_header() const {
    const PlyElement* vertex = find("vertex");
    const PlyElement* face = find("face");
    if (!vertex || vertex->count == 0)
      throw InputError(
          {file_},
          "has no vertices; a PLY mesh with the elements 'vertex' and 'face' was expected");
    if (!face || face->count == 0)
      throw InputError({file_}, fmt::format("has {} vertices but no faces", vertex->count));
    constexpr std::int64_t most = std::numeric_limits<Index>::max();
    if (vertex->count > most || face->count > most)
      throw InputError({file_, vertex->count > most ? vertex->line : face->line},
                       "more than 2147483647 vertices or faces");
    for (const char* axis : {"x", "y", "z"}) {
      const int p = vertex->find({axis});
      if (p < 0 || vertex->properties[static_cast<std::size_t>(p)].is_list)
        throw InputError(
            {file_, vertex->line},
            fmt::format("the element vertex has no property '{}'; x, y and z were expected", axis));
    }
    const int list = face->find({"vertex_indices", "vertex_index"});
    if (list < 0 || !face->properties[static_cast<std::size_t>(list)].is_list ||
        !detail::is_integer(face->properties[static_cast<std::size_t>(list)].type))
      throw InputError(
          {file_, face->line},
          "the element face has no list of whole numbers 'vertex_indices' (or 'vertex_index')");
  }

  [[noreturn]] void fail(const std::string& element, const std::string& message) const {
    throw InputError(data_->place(), element + message + data_->place_in_words());
  }

  std::size_t list_length(const PlyProperty& property, const std::string& element) {
    const double length = data_->number(property.count_type);
    if (!(length >= 0) || length > static_cast<double>(data_->most_left(property.type)))
      fail(element,
           fmt::format(": a list of {:g} numbers, which is more than the rest of the file holds",
                       length));
    return static_cast<std::size_t>(length);
  }

  void pass_over(const PlyProperty& property, const std::string& element) {
    const std::size_t numbers = property.is_list ? list_length(property, element) : 1;
    for (std::size_t k = 0; k < numbers; ++k) data_->number(property.type);
  }

  void pass_over(const PlyElement& element) {
    for (std::int64_t i = 0; i < element.count; ++i) {
      data_->begin_element();
      for (const PlyProperty& property : element.properties) pass_over(property, element.name);
      data_->end_element();
    }
  }

  double finite_number(const PlyProperty& property, Index vertex) {
    const double value = data_->number(property.type);
    if (!std::isfinite(value))
      fail(fmt::format("vertex {}", vertex),
           fmt::format(": {} is {}, a finite number was expected; mend this vertex in the program "
                       "that wrote the file",
                       property.name, value));
    return value;
  }

  void read_vertices(const PlyElement& element) {
    // Where each property of a vertex goes: 0 to 2 coordinates, 3 and 4 texture coordinates.
    std::vector<int> target(element.properties.size(), -1);
    const auto aim = [&](std::initializer_list<std::string_view> names, int to) {
      const int p = element.find(names);
      const bool usable = p >= 0 && !element.properties[static_cast<std::size_t>(p)].is_list;
      if (usable) target[static_cast<std::size_t>(p)] = to;
      return usable;
    };
    aim({"x"}, 0), aim({"y"}, 1), aim({"z"}, 2);
    const bool has_u = aim({"s", "u", "texture_u"}, 3), has_v = aim({"t", "v", "texture_v"}, 4);
    for (Index i = 0; i < static_cast<Index>(element.count); ++i) {
      double values[5] = {};
      data_->begin_element();
      for (std::size_t p = 0; p < target.size(); ++p) {
        if (target[p] >= 0)
          values[target[p]] = finite_number(element.properties[p], i);
        else
          pass_over(element.properties[p], "vertex");
      }
      data_->end_element();
      mesh_.positions.emplace_back(values[0], values[1], values[2]);
      if (has_u && has_v) mesh_.texcoords.emplace_back(values[3], values[4]);
    }
  }

  void read_faces(const PlyElement& element) {
    const auto list = static_cast<std::size_t>(element.find({"vertex_indices", "vertex_index"}));
    for (Index i = 0; i < static_cast<Index>(element.count); ++i) {
      data_->begin_element();
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        if (p == list)
          read_corners(element.properties[p], i);
        else
          pass_over(element.properties[p], "face");
      }
      data_->end_element();
    }
  }

  void read_corners(const PlyProperty& property, Index face) {
    const std::string name = fmt::format("face {}", face);
    const auto vertices = static_cast<double>(find("vertex")->count);
    const std::size_t corners = list_length(property, name);
    if (corners < 3)
      fail(name,
           fmt::format(" has {} corners, at least 3 were expected; remove it or mend it", corners));
    for (std::size_t k = 0; k < corners; ++k) {
      const double index = data_->number(property.type);
      if (!(index >= 0 && index < vertices))
        fail(name,
             fmt::format(" names vertex {:.0f}, 0 to {:.0f} was expected", index, vertices - 1));
      corner_.push_back(static_cast<Index>(index));
    }
    face_end_.push_back(corner_.size());
  }

  void cut_faces() {
    std::size_t begin = 0;
    for (std::size_t f = 0; f < face_end_.size(); begin = face_end_[f++]) {
      const std::span<const Index> corner(corner_.data() + begin, face_end_[f] - begin);
      const std::optional<Index> start = unfolded_fan_start(corner, mesh_.positions);
      if (!start && notes_)
        notes_->push_back(
            located({file_}, fmt::format("face {} has dents or crosses itself and folds over when "
                                         "cut into triangles; triangulate it "
                                         "before export",
                                         f)));
      append_fan(corner, start.value_or(0), mesh_.triangles);
    }
  }

  std::string file_;
  detail::PlyHeader header_;
  std::unique_ptr<detail::PlyData> data_;
  std::vector<std::string>* notes_;
  TriangleMesh mesh_;
  std::vector<Index> corner_;  // of all faces, one after the other
  std::vector<std::size_t> face_end_;
};

}  // namespace

TriangleMesh read_ply(const std::filesystem::path& path, std::vector<std::string>* notes) {
  const std::string bytes = read_unpacked_file(path);
  return PlyReader(path.string(), bytes, notes).read();
}

}  // namespace taut
