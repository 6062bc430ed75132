#include "taut/io/ply.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <random>

#include "io/temporary_folder.h"
#include "taut/base/error.h"
#include "taut/io/mesh_file.h"

namespace taut::test {
namespace {

// A square with a triangle beside it, colours that are no coordinates, an element that is passed
// over.
constexpr const char* text_file = R"(ply
format ascii 1.0
comment by hand
element vertex 5
property float x
property double y
property float z
property uchar red
property float s
property float t
element edge 1
property int vertex1
property int vertex2
element face 2
property uchar material
property list uchar int vertex_index
end_header
0 0 0 255 0 0
1 0 0 255 1 0

1 1.25 -2e1 255 1 1
0 1 0 255 0 1
2 0.5 0 0 2 0.5
0 1
7 4 0 1 2 3
7 3 1 4 2
)";

const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {1, 1.25, -20}, {0, 1, 0}, {2, 0.5, 0}};
const std::vector<Vec2> texcoords{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0.5}};

void check_mesh(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.positions, positions);
  EXPECT_EQ(mesh.texcoords, texcoords);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {1, 4, 2}}));
}

template <class T>
void append(std::string& bytes, T value, bool big_endian) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big_endian) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

// The same mesh in bytes (for a little-endian machine).
std::string binary_file(bool big_endian) {
  std::string bytes = text_file;
  bytes.resize(bytes.find("end_header\n") + 11);
  bytes.replace(bytes.find("ascii"), 5, big_endian ? "binary_big_endian" : "binary_little_endian");
  const auto put = [&](auto value) { append(bytes, value, big_endian); };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    put(static_cast<float>(positions[i].x())), put(positions[i].y()),
        put(static_cast<float>(positions[i].z()));
    put(std::uint8_t{255}), put(static_cast<float>(texcoords[i].x())),
        put(static_cast<float>(texcoords[i].y()));
  }
  for (const int end : {0, 1}) put(end);
  put(std::uint8_t{7}), put(std::uint8_t{4});
  for (const int corner : {0, 1, 2, 3}) put(corner);
  put(std::uint8_t{7}), put(std::uint8_t{3});
  for (const int corner : {1, 4, 2}) put(corner);
  return bytes;
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

std::string every_line_end(const std::string& text, const std::string& end) {
  std::string result;
  for (const char c : text) result += c == '\n' ? end : std::string(1, c);
  return result;
}

TEST(ReadPly, TextAndBothBinaryOrdersAreTheSameMesh) {
  const TemporaryFolder folder;
  check_mesh(read_ply(folder.file("a.ply", text_file)));
  check_mesh(read_ply(folder.file("a.ply", every_line_end(text_file, "\r\n"))));
  check_mesh(read_ply(folder.file("a.ply", every_line_end(text_file, "\r"))));
  check_mesh(read_ply(folder.file("a.ply", binary_file(false))));
  check_mesh(read_ply(folder.file("a.ply", binary_file(true))));
}

TEST(ReadPly, GzipAndExtensions) {
  const TemporaryFolder folder;
  const std::string packed = (folder / "a.PLY.gz").string(), bytes = binary_file(false);
  gzFile file = gzopen(packed.c_str(), "wb");
  gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(file);
  check_mesh(read_mesh(packed));
  EXPECT_EQ(
      read_mesh(folder.file("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")).triangles.size(), 1u);
  EXPECT_THROW(read_mesh(folder.file("t.stl", text_file)), InputError);
}

TEST(ReadPly, WhatIsWrittenReadsBack) {
  const TemporaryFolder folder;
  TriangleMesh mesh{{{0.1F, -2e30F, 3}, {1, 0, 0}, {0, 1, 1e-30F}},
                    {{0, 1, 2}, {2, 1, 0}},
                    {{0.25, 1}, {0, 0.1F}, {7, 8}}};
  for (int with_texcoords = 1; with_texcoords >= 0; --with_texcoords) {
    if (!with_texcoords) mesh.texcoords.clear();
    write_ply(folder / "b.ply", mesh);
    const TriangleMesh back = read_ply(folder / "b.ply");
    EXPECT_EQ(back.positions, mesh.positions);
    EXPECT_EQ(back.triangles, mesh.triangles);
    EXPECT_EQ(back.texcoords, mesh.texcoords);
  }
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(ReadPly, RefusesWithThePlace) {
  const TemporaryFolder folder;
  const std::string text = text_file, binary = binary_file(false);
  const std::string header = binary.substr(0, binary.find("end_header\n") + 11);
  std::string far_index = binary, nan_vertex = binary;
  far_index[binary.size() - 4] = 5;
  const float nan = std::nanf("");
  std::memcpy(nan_vertex.data() + header.size() + 25, &nan, 4);
  const std::vector<std::pair<std::string, std::string>> bad{
      {"", ":1: is no PLY file"},
      {"plyx\n", ":1: is no PLY file"},
      {"ply\nformat ascii 1.0\n", "ends without 'end_header'"},
      {replaced(text, "ascii", "asci"), ":2:8: the format is 'asci'"},
      {replaced(text, "1.0", "2.0"), ":2:14: the format's version is '2.0'"},
      {replaced(text, "format ascii 1.0\n", ""), "has no 'format' line"},
      {replaced(text, "vertex 5", "vertex -5"), ":4:16: the number of elements is '-5'"},
      {replaced(text, "vertex 5", "vertex 99999999999999999999"), ":4:16"},
      {replaced(text, "vertex 5", "vertex 4294967301"), ":4: more than 2147483647"},
      {replaced(text, "element edge", "element vertex"), ":11:9: a second element 'vertex'"},
      {replaced(text, "element vertex 5", "comment"), ":5:1: a property before the first element"},
      {replaced(text, "property double y", "property double w"),
       ":4: the element vertex has no property 'y'"},
      {replaced(text, "property float z", "property quad z"), ":7:10: the type is 'quad'"},
      {replaced(text, "list uchar int", "list float int"),
       "the length of a list is a whole number"},
      {replaced(text, "list uchar int", "list uchar float"),
       ":14: the element face has no list of whole numbers"},
      {replaced(text, "vertex_index", "corners"), ":14: the element face has no list"},
      {replaced(text, "face 2", "face 0"), "has 5 vertices but no faces"},
      {replaced(text, "1.25", "nan"), "vertex 2: y is nan, a finite number was expected"},
      {replaced(text, "1.25", "1e999"), ":21:3: found '1e999', which is too large"},
      {replaced(text, "1.25", "one"), ":21:3: found 'one', a number was expected"},
      {replaced(text, "7 3 1 4 2\n", ""), ":26:1: the file ends before all elements"},
      {replaced(text, "7 3 1 4 2", "7 3 1 4"), ":26:8: a number is missing"},
      {replaced(text, "7 3 1 4 2", "7 3 1 4 2 2"),
       ":26:11: found '2', the end of the line was expected"},
      {replaced(text, "7 3 1 4 2", "7 3 1 4.5 2"),
       ":26:7: found '4.5', a whole number was expected"},
      {replaced(text, "7 3 1 4 2", "7 3 1 5 2"),
       ":26:7: face 1 names vertex 5, 0 to 4 was expected"},
      {replaced(text, "7 3 1 4 2", "7 3 1 -1 2"), ":26:7: face 1 names vertex -1"},
      {replaced(text, "7 3 1 4 2", "7 2 1 4"), ":26:3: face 1 has 2 corners"},
      {replaced(text, "7 3 1 4 2", "7 3000000000 1 4"), ":26:3: face 1: a list of 3e+09 numbers"},
      {replaced(text, "7 3 1 4 2", "7 -3 1 4"), ":26:3: face 1: a list of -3 numbers"},
      {binary.substr(0, header.size() + 30),
       fmt::format("ends at byte {}, before all elements", header.size() + 30)},
      {binary.substr(0, binary.size() - 1),
       "face 1: a list of 3 numbers, which is more than the rest of the file holds"},
      {replaced(binary, "vertex 5", "vertex 2000000000"), "before all elements"},
      {far_index,
       fmt::format("face 1 names vertex 5, 0 to 4 was expected (byte {})", binary.size() - 3)},
      {nan_vertex, fmt::format("vertex 1: x is nan, a finite number was expected; mend this vertex "
                               "in the program that wrote the file (byte {})",
                               header.size() + 26)}};
  for (const auto& [bytes, said] : bad) {
    const std::filesystem::path path = folder.file("bad.ply", bytes);
    try {
      read_ply(path);
      ADD_FAILURE() << "read: " << said;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind(path.string(), 0), 0u) << error.what();
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos)
          << "expected '" << said << "', found: " << error.what();
    }
  }
}

TEST(ReadPly, AnElementWithoutPropertiesTakesNoTime) {
  const TemporaryFolder folder;
  check_mesh(read_ply(folder.file(
      "a.ply",
      replaced(text_file, "element face", "element nothing 9000000000000000000\nelement face"))));
}

// Whatever bytes are wrong: a mesh whose indices fit, or an InputError. Sanitizers look on.
TEST(ReadPly, DamagedFilesDoNoHarm) {
  const TemporaryFolder folder;
  std::mt19937 random(20);
  int read = 0;
  for (const std::string& whole : {std::string(text_file), binary_file(false)}) {
    for (int trial = 0; trial < 400; ++trial) {
      std::string bytes = whole;
      for (unsigned n = 1 + random() % 3; n > 0; --n)
        bytes[random() % bytes.size()] = static_cast<char>(random());
      if (trial % 4 == 0) bytes.resize(random() % bytes.size());
      try {
        const TriangleMesh mesh = read_ply(folder.file("a.ply", bytes));
        ++read;
        for (const Triangle& t : mesh.triangles)
          for (const Index v : t) ASSERT_LT(static_cast<std::size_t>(v), mesh.positions.size());
      } catch (const InputError&) {
      }
    }
  }
  EXPECT_GT(read, 20);
}

}  // namespace
}  // namespace taut::test
