// USD meshes, made by OpenUSD itself (PyPI's usd-core, which ./taut test fetches into
// build/test-python; without it those tests are skipped).

#include "taut/io/usd.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <optional>

#include "io/temporary_folder.h"
#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/io/child_process.h"
#include "taut/io/mesh_file.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

// $TAUT_PYTHON for as long as this lives.
class ChosenPython {
 public:
  explicit ChosenPython(const fs::path& python) {
    if (const char* before = std::getenv("TAUT_PYTHON")) before_ = before;
    ::setenv("TAUT_PYTHON", python.c_str(), 1);
  }
  ~ChosenPython() {
    if (before_)
      ::setenv("TAUT_PYTHON", before_->c_str(), 1);
    else
      ::unsetenv("TAUT_PYTHON");
  }
  ChosenPython(const ChosenPython&) = delete;
  ChosenPython& operator=(const ChosenPython&) = delete;

 private:
  std::optional<std::string> before_;
};

std::string refusal(const fs::path& path, const std::string& prim = "") {
  try {
    read_usd(path, prim);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

class Usd : public testing::Test {
 protected:
  // Runs lines of Python that make `stage` a file of this name.
  fs::path made(const std::string& name, const std::string& lines) {
    const std::string script =
        "import sys\nfrom pxr import Gf, Sdf, Usd, UsdGeom, Vt\nstage = "
        "Usd.Stage.CreateNew(sys.argv[1])\n" +
        lines + "\nstage.Save()\n";
    const ChildEnd end = run_child({python_.string(), "-c", script, (folder_ / name).string()},
                                   std::chrono::seconds(60));
    EXPECT_EQ(end.code, 0) << end.errors;
    return folder_ / name;
  }

  void SetUp() override {
    if (!fs::exists(python_))
      GTEST_SKIP() << "no build/test-python; ./taut test fetches it (tools/requirements-test.txt)";
    chosen_.emplace(python_);
  }

  const fs::path python_ = fs::path(TAUT_SOURCE_DIR) / "build/test-python/bin/python";
  const test::TemporaryFolder folder_;
  std::optional<ChosenPython> chosen_;
};

// A quad and a triangle: five points in centimetres, Y up.
const std::string house = R"(
def house(path):
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr([(0, 0, 0), (100, 0, 0), (100, 100, 0), (0, 100, 0), (50, 150, 10)])
    mesh.CreateFaceVertexCountsAttr([4, 3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3, 3, 2, 4])
    return mesh
)";

void expect_near(const Vec3& value, const Vec3& expected) {
  EXPECT_LT((value - expected).norm(), 1e-6) << value.transpose();
}

TEST_F(Usd, UnitsAxesAndTransformsAreApplied) {
  const TriangleMesh mesh = read_mesh(made("house.usdc", house + R"(
UsdGeom.SetStageMetersPerUnit(stage, 0.01)
UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
world = UsdGeom.Xform.Define(stage, "/World")
world.AddTranslateOp().Set((0, 0, 200))
world.AddRotateYOp().Set(90)
mesh = house("/World/House")
mesh.AddScaleOp().Set((2, 2, 2))
)"));
  ASSERT_EQ(mesh.positions.size(), 5u);
  // (x, y, z) cm -> twice, turned about y ((x, y, z) becomes (z, y, -x)), moved, in metres, y up to
  // z up.
  expect_near(mesh.positions[0], Vec3(0, -2, 0));
  expect_near(mesh.positions[1], Vec3(0, 0, 0));
  expect_near(mesh.positions[4], Vec3(0.2, -1, 3));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {3, 2, 4}}));
  EXPECT_TRUE(mesh.texcoords.empty());
}

TEST_F(Usd, TextureCoordinatesOfVerticesAndOfCorners) {
  const std::string stage =
      house +
      "UsdGeom.SetStageMetersPerUnit(stage, 1)\nUsdGeom.SetStageUpAxis(stage, "
      "UsdGeom.Tokens.z)\nmesh = house(\"/House\")\n"
      "api = UsdGeom.PrimvarsAPI(mesh)\n";
  const TriangleMesh by_vertex = read_usd(made("vertex.usda", stage + R"(
api.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex").Set([(0, 0), (1, 0), (1, 0.5), (0, 0.5), (0.5, 1)])
)"));
  expect_near(by_vertex.positions[4], Vec3(50, 150, 10));
  ASSERT_EQ(by_vertex.texcoords.size(), 5u);
  EXPECT_EQ(by_vertex.texcoords[2], Vec2(1, 0.5));
  const TriangleMesh by_corner = read_usd(made("corner.usda", stage + R"(
st = api.CreatePrimvar("UVMap", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying")
st.Set([(0, 0), (1, 0), (1, 0.5), (0, 0.5), (0.5, 1)])
st.SetIndices([0, 1, 2, 3, 3, 2, 4])
)"));
  EXPECT_EQ(by_corner.texcoords, by_vertex.texcoords);
}

TEST_F(Usd, LeftHandedAndMirroredMeshesAreTurnedOnce) {
  const std::string stage = house + "mesh = house(\"/House\")\n";
  const auto area = [&](const char* name, const std::string& lines) {
    const TriangleMesh mesh = read_usd(made(name, stage + lines));
    Vec3 sum = Vec3::Zero();
    for (const Triangle& t : mesh.triangles)
      sum += (mesh.positions[t[1]] - mesh.positions[t[0]])
                 .cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
    return sum;
  };
  // Without metersPerUnit and upAxis USD means centimetres, Y up: the front, +z there, is -y here.
  const Vec3 plain = area("plain.usda", "");
  EXPECT_LT(plain.y(), -1.9);
  EXPECT_GT(area("left.usda", "mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)").y(), 1.9);
  // Mirrored in z, what showed its front to +z shows it to -z, which is +y here.
  EXPECT_GT(area("mirror.usda", "mesh.AddScaleOp().Set((1, 1, -1))").y(), 1.9);
  EXPECT_LT(area("both.usda",
                 "mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)\nmesh.AddScaleOp().Set((1, "
                 "1, -1))")
                .y(),
            -1.9);
}

TEST_F(Usd, OfSeveralMeshesOneIsChosen) {
  const fs::path file = made("two.usda", house + R"(
house("/World/Shirt")
other = house("/World/Body/Skin")
other.GetPointsAttr().Set([(0, 0, 0), (200, 0, 0), (200, 100, 0), (0, 100, 0), (50, 150, 10)])
house("/World/Many/A")
house("/World/Many/B")
UsdGeom.Sphere.Define(stage, "/World/Ball")
)");
  const std::string text = refusal(file);
  EXPECT_TRUE(text.starts_with(file.string() + ": holds 4 meshes")) << text;
  for (const char* part : {"prim = \"/World/Shirt\"", "/World/Body/Skin", "/World/Many/B"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_DOUBLE_EQ(read_usd(file, "/World/Shirt").positions[1].x(), 1.0);
  EXPECT_DOUBLE_EQ(read_mesh(file, "/World/Body").positions[1].x(), 2.0);
  EXPECT_NE(refusal(file, "/World/Many").find("holds 2 meshes"), std::string::npos);
  EXPECT_NE(refusal(file, "/World/Ball").find("holds 0 meshes"), std::string::npos);
  EXPECT_NE(refusal(file, "/Nowhere").find("has no prim /Nowhere; its meshes are: /World/Shirt"),
            std::string::npos)
      << refusal(file, "/Nowhere");
  EXPECT_NE(refusal(file, "not a path"), "not refused");
}

TEST_F(Usd, BadFilesAreNamed) {
  const auto refuses = [&](const fs::path& file, const std::string& why) {
    const std::string text = refusal(file);
    EXPECT_TRUE(text.starts_with(file.string() + ": ")) << text;
    EXPECT_NE(text.find(why), std::string::npos) << text;
  };
  write_file(folder_ / "text.usda", "this is no USD");
  refuses(folder_ / "text.usda", "cannot be opened as USD");
  write_file(folder_ / "bytes.usdc", std::string("PXR-USDC\0\0\0\1", 12));
  refuses(folder_ / "bytes.usdc", "cannot be opened as USD");
  refuses(folder_ / "absent.usd", "is not there");
  refuses(made("empty.usda", ""), "holds no mesh");
  refuses(made("faces.usda",
               house + "house(\"/House\").GetFaceVertexIndicesAttr().Set([0, 1, 2, 3, 3, 2, 5])"),
          "do not fit its 5 points");
  refuses(made("nan.usda", house + "house(\"/House\").GetPointsAttr().Set([(0, 0, 0), "
                                   "(float('nan'), 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)])"),
          "not finite");
}

// What is said without Python or without pxr, anywhere.
TEST(UsdWithoutPxr, SaysWhatToDo) {
  const test::TemporaryFolder folder;
  write_file(folder / "mesh.usd", "#usda 1.0\n");
  {
    const ChosenPython none("/nowhere/python3");
    const std::string text = refusal(folder / "mesh.usd");
    EXPECT_NE(text.find("/nowhere/python3 is not there"), std::string::npos) << text;
    EXPECT_NE(text.find("pip install usd-core"), std::string::npos) << text;
  }
  write_file(folder / "python", "#!/bin/sh\necho libusd is broken >&2\nexit 4\n");
  fs::permissions(folder / "python", fs::perms::owner_all);
  const ChosenPython bare(folder / "python");
  const std::string text = refusal(folder / "mesh.usd");
  EXPECT_TRUE(text.starts_with((folder / "mesh.usd").string() + ": ")) << text;
  EXPECT_NE(text.find("has no module pxr that works (libusd is broken)"), std::string::npos)
      << text;
  EXPECT_NE(text.find("OBJ or PLY"), std::string::npos) << text;
}

TEST(MeshFile, APrimIsForUsdOnly) {
  const test::TemporaryFolder folder;
  write_file(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_NO_THROW(read_mesh(folder / "a.obj"));
  EXPECT_THROW(read_mesh(folder / "a.obj", "/World"), InputError);
}

}  // namespace
}  // namespace taut
