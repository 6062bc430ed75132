// Reading and writing scenes: what comes out of a file, and that writing loses nothing.

#include "taut/scene/scene_file.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "io/temporary_folder.h"
#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/scene/scene_simulation.h"
#include "test_data.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

const fs::path source_dir = TAUT_SOURCE_DIR;

// As text too: == takes -0 for 0, and bits decide whether a resumed run goes on as it would have.
void expect_round_trip(const Scene& scene) {
  const std::string text = scene_to_toml(scene);
  Scene again = read_scene_text(text, "/elsewhere/scene.toml");
  again.folder = scene.folder;
  EXPECT_TRUE(again == scene) << text;
  EXPECT_EQ(scene_to_toml(again), text);
}

SolidEntry named(const std::string& name, SolidShape shape) {
  SolidEntry solid;
  solid.name = name;
  solid.shape = shape;
  return solid;
}

// No field of any struct keeps its default.
Scene everything_changed(const fs::path& mesh) {
  Scene s;
  s.title = "quotes \" backslash \\ tab \t unicode µ";
  s.gravity = Vec3(0.1, -0.0, -1.0 / 3);
  s.time = {.step = 1.0 / 300,
            .frames = 7,
            .steps_per_frame = 3,
            .integrator = IntegratorKind::bdf2,
            .newton = {.tolerance = 1e-5, .max_iterations = 99},
            .overshoot_limit = 0.7,
            .max_halvings = 2};
  s.solver = {.name = "mpcg:diagonal",
              .tolerance = 1e-5,
              .max_iterations = 17,
              .reordering = "matrix",
              .reuse_analysis = false};
  s.contact = {.max_passes = 3, .touch_tolerance = 1e-5 / 3};
  s.wind = {.velocity = Vec3(1, 2, 3), .gust = 0.3, .gust_frequency = 0.7};

  Cloth grid;
  grid.name = "grid";
  grid.grid = {
      .nu = 4, .nv = 5, .origin = Vec3(0.1, 0.2, 0.3), .u = Vec3(1, 0.5, 0), .v = Vec3(0, 0, -2)};
  grid.node_mass = 1e-5 / 7;
  grid.drag = 1e-6;
  grid.wind_pressure = 0.4;
  grid.material = {.k_stretch = 1e4 / 3,
                   .k_shear = 1,
                   .k_bend = 2,
                   .k_damp_stretch = 3,
                   .k_damp_shear = 4,
                   .k_damp_bend = 5,
                   .bend_cap = 6,
                   .compression = Compression::linear,
                   .bend_model = BendModel::choi_ko};
  grid.velocity = Vec3(-1, 1e-300, 1e300);
  grid.jitter = 1e-4;
  grid.jitter_seed = 99;
  KeyFrame turned{
      0.25,
      {Eigen::Quaterniond(Eigen::AngleAxisd(1.234, Vec3(1, 2, 3).normalized())), Vec3(3, 2, 1)}};
  grid.pins.resize(3);
  grid.pins[0].where.corners = {"u0v1", "u1v1"};
  grid.pins[0].key_frames = {{-0.5, {}}, turned};
  grid.pins[0].pivot = Vec3(1, 1, 1);
  grid.pins[0].release = 0.5;
  grid.pins[1].where.edges = {"v0"};
  grid.pins[2].where.nodes = {3, 7};

  Cloth from_mesh;
  from_mesh.name = "mesh";
  from_mesh.from_file = true;
  from_mesh.mesh = mesh;
  from_mesh.scale = 0.01;
  from_mesh.y_up = true;
  from_mesh.placement = {Eigen::Quaterniond(Eigen::AngleAxisd(-0.7, Vec3::UnitY())), Vec3(0, 0, 5)};
  from_mesh.density = 0.15;
  s.cloths = {grid, from_mesh};

  SolidEntry ball = named("ball", SolidShape::sphere);
  ball.radius = 0.3;
  ball.friction = 0.4;
  ball.thickness = 0.01;
  ball.initial = {Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 6, Vec3::UnitX())), Vec3(1, 2, 3)};
  ball.velocity = Vec3(1, 0, 0);
  ball.angular_velocity = Vec3(0, 2, 0);
  SolidEntry can = named("can", SolidShape::cylinder);
  can.radius = 0.4;
  can.height = 2.5;
  SolidEntry box = named("box", SolidShape::box);
  box.size = Vec3(1, 2, 3);
  box.key_frames = {{0, {}}, turned};
  s.solids = {ball, named("plane", SolidShape::plane), can, box};
  return s;
}

TEST(SceneFile, WritingAndReadingKeepsEveryBit) {
  const test::TemporaryFolder folder;
  write_file(folder / "cloth.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_round_trip(everything_changed(folder / "cloth.obj"));
}

// Most rotations are not those of any written axis and angle: they come back as quaternions, to the
// bit all the same.
TEST(SceneFile, AnyRotationKeepsItsBits) {
  Scene scene = read_scene_text(
      "[[cloth]]\ngrid = { nodes = [2, 2], u = [1, 0, 0], v = [0, 1, 0] }\ndensity = 1\n",
      "/a.toml");
  std::srand(5);
  for (int i = 0; i < 50; ++i) {
    SolidEntry solid = named(std::string("s").append(std::to_string(i)), SolidShape::sphere);
    solid.initial.rotation = Eigen::Quaterniond::UnitRandom();
    scene.solids.push_back(solid);
  }
  expect_round_trip(scene);
}

TEST(SceneFile, RoundAnglesAreWrittenAsAHumanWould) {
  Scene scene = read_scene_text(
      "[[cloth]]\ngrid = { nodes = [2, 2], u = [1, 0, 0], v = [0, 1, 0] }\ndensity = 1\n"
      "[[solid]]\nshape = \"plane\"\nrotation = { axis = [0, 2, 0], degrees = 30 }\n",
      "/a.toml");
  EXPECT_NE(scene_to_toml(scene).find("rotation = { axis = [0, 1, 0], degrees = 30 }"),
            std::string::npos)
      << scene_to_toml(scene);
}

// x turns to -z about +y by 90 degrees: the right-hand rule.
TEST(SceneFile, RotationsAreRightHandedAndBeforeTranslation) {
  const Scene scene = read_scene_text(
      "[[cloth]]\ngrid = { nodes = [2, 2], u = [1, 0, 0], v = [0, 1, 0] }\ndensity = 1\n"
      "[[solid]]\nshape = \"plane\"\nrotation = { axis = [0, 3, 0], degrees = 90 }\ntranslation = "
      "[5, 0, 0]\n",
      "/a.toml");
  EXPECT_LT((scene.solids[0].initial.to_world(Vec3::UnitX()) - Vec3(5, 0, -1)).norm(), 1e-15);
}

TEST(SceneFile, AMeshStartsFromTheFolderOfTheScene) {
  const test::TemporaryFolder folder;
  write_file(folder / "meshes/cloth.obj", "v 0 0 0\n");
  write_file(folder / "scene.toml", "[[cloth]]\nmesh = \"meshes/cloth.obj\"\ndensity = 0.1\n");
  const Scene scene = read_scene(folder / "scene.toml");
  EXPECT_TRUE(scene.cloths[0].from_file);
  EXPECT_TRUE(fs::equivalent(scene.cloths[0].mesh, folder / "meshes/cloth.obj"));
  EXPECT_TRUE(scene.cloths[0].mesh.is_absolute());
}

TEST(SceneFile, LeftOutMeansTheDefaultOfTheStruct) {
  const Scene scene = read_scene_text(
      "[[cloth]]\ngrid = { nodes = [2, 2], u = [1, 0, 0], v = [0, 1, 0] }\ndensity = 1\n",
      "/a.toml");
  EXPECT_TRUE(scene.time == TimeOptions{});
  EXPECT_TRUE(scene.solver == SolverOptions{.name = "auto"});
  EXPECT_TRUE(scene.contact == ContactOptions{});
  EXPECT_TRUE(scene.cloths[0].material == SpringMaterial{});
  EXPECT_EQ(scene.gravity, Vec3(0, 0, -9.81));
  EXPECT_EQ(scene.cloths[0].name, "cloth_0");
}

TEST(SceneFile, AMissingFileIsNamed) {
  try {
    read_scene("/nowhere/scene.toml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/scene.toml"), std::string::npos);
  }
}

TEST(ShippedScenes, AreReadRoundTripAndRaiseNoDoubts) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(source_dir / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path().string());
    ++count;
    // Its body is not part of Taut: any files that are there let it be read.
    const bool without_body = entry.path().stem() == "body";
    const std::string any = "=\"" + (source_dir / "scenes/meshes/tshirt.obj").string() + "\"";
    const std::vector<std::string> stand_in{"solid.0.mesh" + any, "solid.0.motion" + any};
    const Scene scene =
        read_scene(entry.path(), without_body ? stand_in : std::vector<std::string>{});
    EXPECT_FALSE(scene.title.empty());
    EXPECT_TRUE(read_file(entry.path()).starts_with("# ")) << "a comment that says what one sees";
    expect_round_trip(scene);
    if (!without_body) {
      EXPECT_EQ(doubtful(scene), std::vector<std::string>{});
    }
  }
  EXPECT_GE(count, 4);
}

TEST(ShippedScenes, BodyTakesABodyOfOnesOwn) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "no ../shared/data and no $TAUT_DATA";
  const auto quoted = [&](const char* key, const char* name) {
    return std::string(key) + "=\"" + (*data / "body" / name).string() + "\"";
  };
  const std::vector<std::string> settings{quoted("solid.0.mesh", "body_rest_tri.obj"),
                                          quoted("solid.0.motion", "body_A_to_T_9x13380x3.f32")};
  const Scene scene = read_scene(source_dir / "scenes/body.toml", settings);
  EXPECT_EQ(doubtful(scene), std::vector<std::string>{});
  SceneSimulation simulation(scene);
  StepReport record;
  ASSERT_TRUE(simulation.step(record).ok());
  EXPECT_EQ(record.intersections, 0);
}

// The paper's experiment, number by number.
TEST(ShippedScenes, BallIsThePapers) {
  const Scene scene = read_scene(source_dir / "scenes/ball.toml");
  ASSERT_EQ(scene.cloths.size(), 1u);
  const Cloth& sheet = scene.cloths[0];
  const Solid& ball = scene.solids.at(0);
  EXPECT_EQ(sheet.grid.node_count(), 6561);
  EXPECT_EQ(scene.time.step, 5.55e-3);
  EXPECT_EQ(scene.time.integrator, IntegratorKind::semi_implicit_euler);
  EXPECT_EQ(scene.solver.name, "auto");  // the paper's, --solver core_pcg, is an option away
  EXPECT_EQ(sheet.node_mass, 9.5e-6);
  // Springs that push are ours (docs/paper.md says why); the rest is the paper's.
  const SpringMaterial material{.k_stretch = 6000,
                                .k_shear = 0.3,
                                .k_bend = 0.05,
                                .compression = Compression::linear,
                                .bend_model = BendModel::linear};
  EXPECT_TRUE(sheet.material == material);
  EXPECT_EQ(sheet.drag, 1e-6);
  EXPECT_EQ(sheet.grid.u.norm(), 1);
  EXPECT_EQ(sheet.grid.v, Vec3(0, 0, 1));
  EXPECT_EQ(sheet.grid.origin.y(), 0);
  EXPECT_EQ(sheet.pins.at(0).where.corners, (std::vector<std::string>{"u0v1", "u1v1"}));
  EXPECT_EQ(ball.radius, 0.2);
  EXPECT_EQ(ball.friction, 0.3);
  EXPECT_EQ(ball.velocity, Vec3(0, 3, 0));
  const Vec3 centre = sheet.grid.origin + 0.5 * (sheet.grid.u + sheet.grid.v);
  EXPECT_EQ(ball.initial.translation, Vec3(centre - Vec3(0, 0.6, 0)));
}

TEST(SceneReference, TheDocumentedKeysAreThoseOfTheCode) {
  const fs::path page = source_dir / "docs/scene-reference.md";
  const std::string text = scene_reference();
  if (std::getenv("TAUT_UPDATE")) write_file(page, text);
  EXPECT_EQ(read_file(page), text) << "docs/scene-reference.md is out of date: run this test with "
                                      "TAUT_UPDATE=1 in the environment";
}

}  // namespace
}  // namespace taut
