#include "taut/io/obj.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include "io/temporary_folder.h"
#include "taut/base/error.h"
#include "taut/mesh/topology.h"
#include "test_data.h"

namespace taut::test {
namespace {

TriangleMesh parse(std::string_view text, std::vector<std::string>* notes = nullptr) {
  const TemporaryFolder folder;
  return read_obj(folder.file("mesh.obj", text), notes);
}

// The refusal's text after the file's name; "read" when the text was read.
std::string refusal(std::string_view text) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.file("mesh.obj", text);
  try {
    read_obj(path);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind(path.string() + ":", 0), 0u) << message;
    return message.substr(path.string().size());
  }
  return "read";
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ReadObj, AllIndexForms) {
  const std::string text = square + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n";
  const Triangle first = {0, 1, 2};
  for (const char* face :
       {"f 1 2 3", "f 1/1 2/2 3/3", "f 1//1 2//1 3//1", "f 1/1/1 2/2/1 3/3/1", "f -4 -3 -2",
        "f -4/-3/-1 -3/-2/-1 -2/-1/-1", "f 1/ 2/ 3/", "f +1 2 3", "  f\t1  2 3  ",
        "f 1 2 3 # a comment", "f 1 \\\n 2 3", "f 1 2 \\\r\n 3", "fo 1 2 3"}) {
    const TriangleMesh mesh = parse(text + face);
    ASSERT_EQ(mesh.triangles.size(), 1u) << face;
    EXPECT_EQ(mesh.triangles[0], first) << face;
    EXPECT_EQ(mesh.positions.size(), 4u);
  }
}

TEST(ReadObj, RelativeIndicesCountFromTheFaceNotFromTheEnd) {
  const TriangleMesh mesh = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -4 -1 -2\n");
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(mesh.triangles[1], (Triangle{0, 3, 2}));
}

TEST(ReadObj, NumbersInEveryNotation) {
  const TriangleMesh mesh =
      parse("v +1.5 -.5 2.\nv 1e2 1E-002 .8e-001\nv 1e-400 -0 0.1\nf 1 2 3\n");
  EXPECT_EQ(mesh.positions[0], Vec3(1.5, -0.5, 2));
  EXPECT_EQ(mesh.positions[1], Vec3(100, 0.01, 0.08));
  EXPECT_EQ(mesh.positions[2], Vec3(0, 0, 0.1));
}

TEST(ReadObj, LineEndsByteOrderMarkAndColours) {
  for (const char* text : {"\xef\xbb\xbfv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3",
                           "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r",
                           "v 0 0 0 1 0.5 nan\nv 1 0 0 1\nv 0 1 0 1 1 1 1\nf 1 2 3\n"}) {
    const TriangleMesh mesh = parse(text);
    ASSERT_EQ(mesh.positions.size(), 3u);
    EXPECT_EQ(mesh.positions[2], Vec3(0, 1, 0));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  }
}

TEST(ReadObj, CommentThatEndsInABackslashDoesNotSwallowTheNextLine) {
  EXPECT_EQ(parse("# from C:\\\nv 0 0 0\nv 1 0 0 # C:\\\nv 0 1 0\nf 1 2 3\n").positions.size(), 3u);
}

TEST(ReadObj, FacesMayNameLaterVertices) {
  EXPECT_EQ(parse("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").triangles,
            (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(ReadObj, PolygonsBecomeFans) {
  EXPECT_EQ(parse(square + "f 1 2 3 4").triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(ReadObj, FanOfADentedPolygonDoesNotFoldOver) {
  // The dent is at vertex 4: a fan from vertex 1 would cover the outside of it.
  std::vector<std::string> notes;
  const TriangleMesh mesh = parse("v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 0\nf 1 2 3 4\n", &notes);
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[1]] - mesh.positions[t[0]],
               b = mesh.positions[t[2]] - mesh.positions[t[0]];
    EXPECT_GE(a.x() * b.y() - a.y() * b.x(), 0.0);
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  EXPECT_DOUBLE_EQ(area, 6.0);
  EXPECT_TRUE(notes.empty());
}

TEST(ReadObj, PolygonThatNoFanFitsIsNoted) {
  // A comb with three teeth: no corner sees all others.
  std::vector<std::string> notes;
  parse(
      "v 0 0 0\nv 5 0 0\nv 5 3 0\nv 4 3 0\nv 4 1 0\nv 3 1 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\nv 1 1 0\nv "
      "1 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8 9 10 "
      "11 12\n",
      &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("mesh.obj:13: a face with 12 corners has dents"), std::string::npos)
      << notes[0];
}

TEST(ReadObj, TexcoordsOnePerVertexTheFirstCounts) {
  std::vector<std::string> notes;
  const TriangleMesh mesh = parse(
      square + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1 0\nvt .5\nf 1/1 2/2 3/3\nf 1/5 3/3 4/4\n", &notes);
  EXPECT_EQ(mesh.texcoords, (std::vector<Vec2>{{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("1 vertex on texture seams"), std::string::npos) << notes[0];
  EXPECT_TRUE(parse(square + "vt 0 0\nf 1/1 2/1 3\n").texcoords.empty());
}

TEST(ReadObj, UnknownStatementsAreNotedOnce) {
  std::vector<std::string> notes;
  parse(
      "mtllib a.mtl\ng x\no y\ns off\n" + square + "f 1 2 3\nstitch 1 2 3 0.5\nstitch 1 2 3 0.5\n",
      &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("mesh.obj:10: the statement 'stitch' is not OBJ"), std::string::npos)
      << notes[0];
}

TEST(ReadObj, RefusalsNameLineAndColumn) {
  EXPECT_EQ(
      refusal(square + "f 1 2 5\n").rfind(":5:7: index 5 is beyond the 4 vertices of the file", 0),
      0u)
      << refusal(square + "f 1 2 5\n");
  EXPECT_EQ(refusal(square + "f 1 2 3\nf 1 2 99999999999999999999\n")
                .rfind(":6:7: vertex index is '99999999999999999999'", 0),
            0u);
  EXPECT_EQ(refusal(square + "f 1 2 -5\n").rfind(":5:7: vertex index is '-5'", 0), 0u);
  EXPECT_EQ(refusal(square + "f 1/2 2/1 3/1\nvt 0 0\n")
                .rfind(":5:3: index 2 is beyond the 1 texture coordinate ", 0),
            0u);
  EXPECT_EQ(refusal(square + "f 1 2 x\n")
                .rfind(":5:7: vertex index is 'x', a whole number was expected", 0),
            0u);
  EXPECT_EQ(refusal(square + "f 1 2 1.5\n").rfind(":5:7: ", 0), 0u);
  EXPECT_EQ(refusal(square + "f 1 2 3/a/1\n").rfind(":5:7: texture coordinate index is 'a'", 0),
            0u);
  EXPECT_EQ(refusal(square + "f 1 2 3//a\n").rfind(":5:7: normal index is 'a'", 0), 0u);
  EXPECT_EQ(refusal("v 0 0\n").rfind(":1:6: z of the vertex is missing", 0), 0u)
      << refusal("v 0 0\n");
  EXPECT_EQ(refusal("v 0 0 1e999\n").rfind(":1:7: z of the vertex is '1e999', a finite number", 0),
            0u);
  EXPECT_EQ(refusal("v 0 -inf 1\n").rfind(":1:5: y of the vertex is '-inf', a finite number", 0),
            0u);
  EXPECT_EQ(refusal("v 0 0 0 red\n").rfind(":1:9: found 'red'", 0), 0u);
  EXPECT_EQ(refusal("v 0 0 \\\n  x\n").rfind(":2:3: z of the vertex is 'x'", 0), 0u);
  EXPECT_EQ(refusal(square).rfind(": has 4 vertices but no faces", 0), 0u);
  EXPECT_EQ(
      refusal(std::string_view("v 0 0 0\n\0", 9)).rfind(": is not a text file: byte 9 is zero", 0),
      0u);
}

TEST(ReadObj, FolderAndMissingFileAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_obj(folder / ""), InputError);
  EXPECT_THROW(read_obj(folder / "absent.obj"), InputError);
}

TEST(ReadObj, GzipIsUnpackedAndADamagedOneRefused) {
  const TemporaryFolder folder;
  const std::string path = (folder / "mesh.obj.gz").string();
  const gzFile packed = gzopen(path.c_str(), "wb");
  const std::string text = square + "f 1 2 3\n";
  ASSERT_EQ(gzwrite(packed, text.data(), static_cast<unsigned>(text.size())),
            static_cast<int>(text.size()));
  gzclose(packed);
  EXPECT_EQ(read_obj(path).positions.size(), 4u);
  const std::string bytes = read_file(path);
  for (std::size_t length = 2; length < bytes.size(); ++length)
    EXPECT_THROW(read_obj(folder.file("cut.obj.gz", bytes.substr(0, length))), InputError)
        << length;
}

TEST(ReadObj, CutAnywhereItIsReadOrRefused) {
  const std::string text =
      "\xef\xbb\xbf# c\nmtllib a.mtl\n" + square +
      "vt 0 0\nvt 1 0\nvn 0 0 1\nf 1/1/1 2/2/1 \\\n 3/2/1\r\nf -4//-1 -2//-1 -1//-1\n";
  int read = 0;
  for (std::size_t length = 0; length <= text.size(); ++length) {
    try {
      const TriangleMesh mesh = parse(std::string_view(text).substr(0, length));
      ++read;
      for (const Triangle& t : mesh.triangles)
        for (const Index v : t)
          EXPECT_TRUE(v >= 0 && v < static_cast<Index>(mesh.positions.size()));
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(read, 2);
  EXPECT_LT(read, static_cast<int>(text.size()) / 2);
}

TEST(WriteObj, ReadsBackToTheSameBits) {
  TriangleMesh mesh;
  for (int i = 0; i < 50; ++i) {
    mesh.positions.emplace_back(1.0 / (3 + i), -1e-7 * i / 7.0, 1e10 / (i + 0.3));
    mesh.texcoords.emplace_back(i / 49.0, 1 - i / 7.0);
  }
  for (Index i = 0; i + 2 < 50; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "round.obj";
  write_obj(path, mesh);
  const TriangleMesh back = read_obj(path);
  EXPECT_EQ(back.positions, mesh.positions);
  EXPECT_EQ(back.texcoords, mesh.texcoords);
  EXPECT_EQ(back.triangles, mesh.triangles);
  mesh.texcoords.clear();
  write_obj(path, mesh);
  EXPECT_TRUE(read_obj(path).texcoords.empty());
  EXPECT_EQ(read_obj(path).positions, mesh.positions);
}

TEST(ReadObj, TShirtBodyAndDress) {
  const auto data = data_folder();
  if (!data) GTEST_SKIP() << "no ../shared/data and no $TAUT_DATA";
  const TriangleMesh shirt = read_obj(*data / "tshirt/tshirt.obj");
  EXPECT_EQ(shirt.positions.size(), 2799u);
  EXPECT_EQ(shirt.triangles.size(), 5483u);
  EXPECT_EQ(shirt.texcoords.size(), 2799u);
  EXPECT_NO_THROW(check_cloth_mesh(shirt, "tshirt.obj"));
  const Topology topology = build_topology(shirt);
  EXPECT_EQ(topology.hinges.size() + topology.boundary_edges.size(), topology.edges.size());
  EXPECT_EQ(2 * topology.hinges.size() + topology.boundary_edges.size(),
            3 * shirt.triangles.size());
  // A shirt has four holes: V - E + F = 2 - 4.
  EXPECT_EQ(2799 - static_cast<int>(topology.edges.size()) + 5483, -2);
  const TriangleMesh body = read_obj(*data / "body/body_rest_tri.obj");
  EXPECT_EQ(body.positions.size(), 13380u);
  EXPECT_EQ(body.triangles.size(), 26756u);
  EXPECT_TRUE(build_topology(body).boundary_edges.empty());
  std::vector<std::string> notes;
  const TriangleMesh dress = read_obj(*data / "stitched-dress/dress_knife_stage.obj.gz", &notes);
  EXPECT_EQ(dress.positions.size(), 15656u);
  EXPECT_EQ(dress.triangles.size(), 29456u);
  EXPECT_EQ(notes.size(), 2u);  // stitch and seam
}

}  // namespace
}  // namespace taut::test
