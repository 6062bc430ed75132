#include "taut/io/obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "taut/io/polygon_fan.h"
#include "taut/io/text_cursor.h"
#include "taut/io/text_file.h"

namespace taut {

namespace {

constexpr Index no_texcoord = -1;

// Statements of the OBJ format that say nothing about the triangles.
constexpr std::array<std::string_view, 35> passed_over = {
    "vn",       "vp",   "g",          "o",         "s",      "mg",    "usemtl",
    "mtllib",   "l",    "p",          "usemap",    "maplib", "bevel", "c_interp",
    "d_interp", "lod",  "shadow_obj", "trace_obj", "ctech",  "stech", "cstype",
    "deg",      "bmat", "step",       "curv",      "curv2",  "surf",  "parm",
    "trim",     "hole", "scrv",       "sp",        "end",    "con",   "call"};

std::string count_of(std::size_t count, std::string_view noun) {
  if (count == 1) return "1 " + std::string(noun);
  return std::to_string(count) + " " + (noun == "vertex" ? "vertices" : std::string(noun) + "s");
}

class ObjReader {
 public:
  ObjReader(std::string file, std::string_view text, std::vector<std::string>* notes)
      : cursor_(std::move(file), text, true), notes_(notes) {}

  TriangleMesh read() {
    for (; !cursor_.at_end(); cursor_.next_line()) read_statement();
    if (mesh_.positions.empty())
      throw InputError({cursor_.file()},
                       "has no vertices; an OBJ file with 'v' and 'f' lines was expected");
    if (face_end_.empty())
      throw InputError({cursor_.file()}, "has " + count_of(mesh_.positions.size(), "vertex") +
                                             " but no faces ('f' lines)");
    check_forward(forward_vertices_, mesh_.positions.size(), "vertex");
    check_forward(forward_texcoords_, texcoords_.size(), "texture coordinate");
    cut_faces();
    set_texcoords();
    return std::move(mesh_);
  }

 private:
  struct ForwardIndex {
    Index value;
    int line, column;
  };

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(cursor_.place(), message);
  }
  void note(int line, const std::string& message) {
    if (notes_) notes_->push_back(located({cursor_.file(), line}, message));
  }

  // A word of nothing or of a comment's beginning ends a statement.
  bool is_comment(std::string_view word) {
    if (!word.empty() && word[0] == '#') cursor_.skip_comment();
    return word.empty() || word[0] == '#';
  }

  void read_statement() {
    const std::string_view keyword = cursor_.word();
    if (is_comment(keyword)) return;
    if (keyword == "v")
      read_vertex();
    else if (keyword == "vt")
      read_texcoord();
    else if (keyword == "f" || keyword == "fo")  // fo: the name of f before version 3 of the format
      read_face();
    else if (std::find(passed_over.begin(), passed_over.end(), keyword) == passed_over.end())
      note_unknown(keyword);
  }

  void note_unknown(std::string_view keyword) {
    constexpr std::size_t most_named = 20;
    const std::string name = in_quotes(keyword);
    if (unknown_.size() >= most_named ||
        std::find(unknown_.begin(), unknown_.end(), name) != unknown_.end())
      return;
    unknown_.push_back(name);
    note(cursor_.line_of_word(),
         "the statement " + name + " is not OBJ; lines with it were passed over");
  }

  // The next word, or a given one, as a finite number.
  double number(const char* what) { return number(what, cursor_.word()); }
  double number(const char* what, std::string_view word) {
    if (word.empty() || word[0] == '#')
      fail(std::string(what) + " is missing; the line ends too early");
    double value = 0;
    const NumberFault fault = parse_number(word, value);
    if (fault == NumberFault::not_a_number)
      fail(std::string(what) + " is " + in_quotes(word) + ", a number was expected");
    if (fault == NumberFault::too_large || !std::isfinite(value))
      fail(std::string(what) + " is " + in_quotes(word) +
           ", a finite number was expected; mend this vertex in the program that wrote the file");
    return value;
  }

  // Words after the numbers that are used: numbers too, whatever they mean.
  void pass_numbers() {
    while (!cursor_.at_line_end()) {
      const std::string_view word = cursor_.word();
      double unused = 0;
      if (is_comment(word)) return;
      if (parse_number(word, unused) == NumberFault::not_a_number)
        fail("found " + in_quotes(word) + ", a number or the end of the line was expected");
    }
  }

  void read_vertex() {
    const double x = number("x of the vertex");
    const double y = number("y of the vertex");
    const double z = number("z of the vertex");
    pass_numbers();
    mesh_.positions.emplace_back(x, y, z);
  }

  void read_texcoord() {
    const double u = number("u of the texture coordinate");
    // A one-dimensional texture has no v.
    const std::string_view word = cursor_.word();
    const double v = is_comment(word) ? 0.0 : number("v of the texture coordinate", word);
    pass_numbers();
    texcoords_.emplace_back(u, v);
  }

  // OBJ's index (from 1, or from -1 backwards) to one from 0; those that point ahead are checked at
  // the end of the file.
  Index resolve(std::string_view digits, std::size_t count, const char* what,
                std::vector<ForwardIndex>& forward) {
    std::int64_t index = 0;
    const NumberFault fault = parse_integer(digits, index);
    if (fault == NumberFault::not_a_number)
      fail(std::string(what) + " index is " + in_quotes(digits) +
           ", a whole number was expected (a corner is v, v/vt, v//vn or v/vt/vn)");
    if (fault == NumberFault::none && index == 0)
      fail(std::string(what) + " index is 0; OBJ counts from 1");
    const auto known = static_cast<std::int64_t>(count);
    if (fault == NumberFault::too_large || index > std::numeric_limits<Index>::max() ||
        index < -known)
      fail(std::string(what) + " index is " + in_quotes(digits) + ", but the file has only " +
           std::to_string(count) + " so far");
    if (index < 0) return static_cast<Index>(known + index);
    const Index value = static_cast<Index>(index - 1);
    if (index > known) forward.push_back({value, cursor_.line_of_word(), cursor_.column_of_word()});
    return value;
  }

  void read_face() {
    const int line = cursor_.line_of_word();
    const int column = cursor_.column_of_word();
    const std::size_t first = corner_vertex_.size();
    while (!cursor_.at_line_end()) {
      const std::string_view corner = cursor_.word();
      if (is_comment(corner)) break;
      read_corner(corner);
    }
    const std::size_t corners = corner_vertex_.size() - first;
    if (corners < 3)
      throw InputError({cursor_.file(), line, column},
                       "a face with " + count_of(corners, "corner") +
                           ", at least 3 were expected; remove it or mend it");
    face_end_.push_back(corner_vertex_.size());
    face_line_.push_back(line);
  }

  void read_corner(std::string_view corner) {
    const std::size_t slash = std::min(corner.find('/'), corner.size());
    corner_vertex_.push_back(
        resolve(corner.substr(0, slash), mesh_.positions.size(), "vertex", forward_vertices_));
    const std::string_view rest =
        slash < corner.size() ? corner.substr(slash + 1) : std::string_view{};
    const std::size_t second = std::min(rest.find('/'), rest.size());
    const std::string_view texcoord = rest.substr(0, second);
    corner_texcoord_.push_back(
        texcoord.empty()
            ? no_texcoord
            : resolve(texcoord, texcoords_.size(), "texture coordinate", forward_texcoords_));
    if (second < rest.size()) check_normal(rest.substr(second + 1));
  }

  // Normals are not used, so an index beyond them does no harm; but it must be an index.
  void check_normal(std::string_view normal) const {
    std::int64_t unused = 0;
    if (!normal.empty() && parse_integer(normal, unused) == NumberFault::not_a_number)
      fail("normal index is " + in_quotes(normal) +
           ", a whole number was expected (a corner is v, v/vt, v//vn or v/vt/vn)");
  }

  void check_forward(const std::vector<ForwardIndex>& forward, std::size_t count,
                     const char* what) const {
    for (const ForwardIndex& index : forward)
      if (static_cast<std::size_t>(index.value) >= count)
        throw InputError({cursor_.file(), index.line, index.column},
                         "index " + std::to_string(Offset{index.value} + 1) + " is beyond the " +
                             count_of(count, what) + " of the file");
  }

  void cut_faces() {
    std::size_t begin = 0;
    for (std::size_t f = 0; f < face_end_.size(); begin = face_end_[f++]) {
      const std::span<const Index> corner(corner_vertex_.data() + begin, face_end_[f] - begin);
      const std::optional<Index> start = unfolded_fan_start(corner, mesh_.positions);
      if (!start)
        note(face_line_[f], "a face with " + count_of(corner.size(), "corner") +
                                " has dents or crosses itself and folds over when cut into "
                                "triangles; triangulate it before export");
      append_fan(corner, start.value_or(0), mesh_.triangles);
    }
  }

  void set_texcoords() {
    std::vector<Index> chosen(mesh_.positions.size(), no_texcoord);
    std::vector<char> several(chosen.size(), 0);
    bool complete = true;
    for (std::size_t c = 0; c < corner_vertex_.size(); ++c) {
      Index& texcoord = chosen[corner_vertex_[c]];
      if (texcoord == no_texcoord) texcoord = corner_texcoord_[c];
      if (corner_texcoord_[c] != no_texcoord &&
          texcoords_[corner_texcoord_[c]] != texcoords_[texcoord])
        several[corner_vertex_[c]] = 1;
    }
    for (const Index vertex : corner_vertex_) complete = complete && chosen[vertex] != no_texcoord;
    if (!complete) return;
    mesh_.texcoords.assign(chosen.size(), Vec2::Zero());
    for (std::size_t v = 0; v < chosen.size(); ++v)
      if (chosen[v] != no_texcoord) mesh_.texcoords[v] = texcoords_[chosen[v]];
    const auto seams = static_cast<std::size_t>(std::count(several.begin(), several.end(), 1));
    if (seams > 0)
      note(0, count_of(seams, "vertex") +
                  " on texture seams; each keeps the first of its texture coordinates");
  }

  TextCursor cursor_;
  std::vector<std::string>* notes_;
  TriangleMesh mesh_;
  std::vector<Vec2> texcoords_;
  std::vector<Index> corner_vertex_, corner_texcoord_;  // of all faces, one after the other
  std::vector<std::size_t> face_end_;
  std::vector<int> face_line_;
  std::vector<ForwardIndex> forward_vertices_, forward_texcoords_;
  std::vector<std::string> unknown_;
};

}  // namespace

TriangleMesh read_obj(const std::filesystem::path& path, std::vector<std::string>* notes) {
  return parse_obj(path.string(), read_text_file(path), notes);
}

TriangleMesh parse_obj(const std::string& file, std::string_view text,
                       std::vector<std::string>* notes) {
  return ObjReader(file, text, notes).read();
}

}  // namespace taut
