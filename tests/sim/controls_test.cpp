// What a program changes between steps.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/hanging_sheet.h"
#include "taut/mesh/topology.h"
#include "taut/sim/validator.h"

namespace taut::test {
namespace {

constexpr double h = 5e-3;

// Closed forms are met to rounding by a direct solver only.
const SimulationOptions exact{.solver = {.name = "block_cholesky"}};

void run(Simulation& simulation, int steps, double step = h) {
  for (int k = 0; k < steps; ++k) {
    const StepReport report = simulation.step(step);
    ASSERT_TRUE(report.ok()) << report.message();
  }
}

template <class Call>
std::string refusal(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Without contact and forces but gravity: x = x0 + v0 t + ..., of implicit Euler exactly.
TEST(Controls, GravityAndForcesMoveAFreeSheet) {
  HangingSheet sheet(3);
  World world;
  const ClothHandle free = world.add_cloth(sheet.world.cloths()[0]);
  world.gravity = Vec3::Zero();
  Simulation simulation(world, exact);
  run(simulation, 2);
  EXPECT_EQ(simulation.velocities(free)[4], Vec3::Zero());
  simulation.set_gravity(Vec3(0, 2, 0));
  run(simulation, 3);
  for (const Vec3& v : simulation.velocities(free)) EXPECT_NEAR(v.y(), 3 * h * 2, 1e-12);
  simulation.set_gravity(Vec3::Zero());
  std::vector<Vec3> force;
  for (const double a : vertex_areas(world.cloths()[0].mesh))
    force.push_back(Vec3(0, 0, 0.15 * a * 5.0));
  simulation.set_forces(free, force);
  run(simulation, 4);
  for (const Vec3& v : simulation.velocities(free)) EXPECT_NEAR(v.z(), 4 * h * 5.0, 1e-9);
}

TEST(Controls, VelocitiesAreTakenOver) {
  HangingSheet sheet(3);
  World world;
  world.gravity = Vec3::Zero();
  const ClothHandle free = world.add_cloth(sheet.world.cloths()[0]);
  for (const IntegratorKind kind : {IntegratorKind::semi_implicit_euler, IntegratorKind::bdf2}) {
    Simulation simulation(world, {.solver = exact.solver, .integrator = kind});
    run(simulation, 2);
    const Vec3 before = simulation.positions(free)[5];
    simulation.set_velocities(free, std::vector<Vec3>(9, Vec3(0, 0, 2)));
    run(simulation, 5);
    EXPECT_NEAR(simulation.positions(free)[5].z() - before.z(), 5 * h * 2, 1e-12);
  }
}

TEST(Controls, APinGoesWhereItIsMoved) {
  HangingSheet sheet;
  Simulation simulation(sheet.world);
  const Vec3 start = simulation.positions(sheet.sheet)[0];
  for (int k = 1; k <= 10; ++k) {
    simulation.move(sheet.pin, Vec3(0, 0, 0.001 * k));
    run(simulation, 1);
    EXPECT_NEAR((simulation.positions(sheet.sheet)[0] - start - Vec3(0, 0, 0.001 * k)).norm(), 0,
                1e-14);
    EXPECT_NEAR(simulation.velocities(sheet.sheet)[0].z(), 0.001 / h, 1e-9);
  }
  run(simulation, 3);  // it stays where it was moved to
  EXPECT_NEAR((simulation.positions(sheet.sheet)[0] - start - Vec3(0, 0, 0.01)).norm(), 0, 1e-14);
  EXPECT_NEAR(simulation.velocities(sheet.sheet)[0].norm(), 0, 1e-12);
}

// Moved by hand along a path of key frames, or by the path itself: the same motion.
TEST(Controls, MovingByHandIsAsAPath) {
  HangingSheet by_hand, by_path;
  const Vec3 speed(0.05, 0, 0.1);
  KeyFrame first, last;
  last.time = 1.0, last.pose.translation = speed;
  World world;
  const ClothHandle sheet = world.add_cloth(by_path.world.cloths()[0]);
  world.pin(sheet, {0, 8}, {.key_frames = {first, last}});
  world.add_solid(by_path.world.solids()[0]);
  Simulation path(world), hand(by_hand.world);
  for (int k = 1; k <= 30; ++k) {
    hand.move(by_hand.pin, (k * h) * speed);
    run(hand, 1);
    run(path, 1);
  }
  for (Index i = 0; i < 81; ++i)
    EXPECT_NEAR((hand.positions(by_hand.sheet)[i] - path.positions(sheet)[i]).norm(), 0, 1e-9);
}

TEST(Controls, PinsAreReleasedHeldAndAdded) {
  HangingSheet sheet;
  Simulation simulation(sheet.world);
  run(simulation, 5);
  simulation.release(sheet.pin);
  run(simulation, 5);
  const Vec3 fallen = simulation.positions(sheet.sheet)[0];
  EXPECT_LT(fallen.z(), -1e-3);
  simulation.hold(sheet.pin);
  const Index middle = 4;
  const PinHandle added = simulation.pin(sheet.sheet, {middle});
  const Vec3 there = simulation.positions(sheet.sheet)[middle];
  run(simulation, 5);
  EXPECT_EQ(simulation.positions(sheet.sheet)[0], fallen);
  EXPECT_EQ(simulation.positions(sheet.sheet)[middle], there);
  simulation.place(added, std::vector<Vec3>{there + Vec3(0, 0, 2e-3)});
  run(simulation, 1);
  EXPECT_NEAR((simulation.positions(sheet.sheet)[middle] - there).z(), 2e-3, 1e-14);
}

// A solid moved step by step carries cloth as one with key frames does.
TEST(Controls, MovingASolidIsAsKeyFrames) {
  HangingSheet by_hand, by_path;
  const Vec3 from = by_path.world.solids()[0].initial.translation, way(0, 0, 0.15);
  Solid keyed = by_path.world.solids()[0];
  KeyFrame first, last;
  first.pose.translation = from;
  last.time = 0.5, last.pose.translation = from + way;
  keyed.key_frames = {first, last};
  by_path.world.set_motion(by_path.ball, keyed);
  Simulation path(by_path.world), hand(by_hand.world);
  int touching = 0;
  for (int k = 1; k <= 60; ++k) {
    Pose pose;
    pose.translation = from + (k * h / 0.5) * way;
    hand.move(by_hand.ball, pose);
    const StepReport report = hand.step(h);
    ASSERT_TRUE(report.ok()) << report.message();
    touching += report.contacts;
    run(path, 1);
  }
  EXPECT_GT(touching, 100);
  for (Index i = 0; i < 81; ++i)
    EXPECT_NEAR((hand.positions(by_hand.sheet)[i] - path.positions(by_path.sheet)[i]).norm(), 0,
                5e-4);  // of a way of 0.15 m; contact answers to rounding
}

TriangleMesh floor_mesh(double z) {
  return make_grid(
      {.nu = 2, .nv = 2, .origin = Vec3(-1, -1, z), .u = Vec3(2, 0, 0), .v = Vec3(0, 2, 0)});
}

// A floor that is lifted by its vertices lifts the cloth that lies on it.
TEST(Controls, AMeshSolidIsDeformed) {
  HangingSheet sheet;
  World world;
  ClothOptions lying = sheet.world.cloths()[0];
  for (Vec3& x : lying.mesh.positions) x.z() = 0.002;
  const ClothHandle cloth = world.add_cloth(lying);
  const SolidHandle floor = world.add_solid({.friction = 0.5}, {.mesh = floor_mesh(0.0)});
  Simulation simulation(world);
  run(simulation, 10);
  for (int k = 1; k <= 20; ++k) {
    simulation.deform(floor, floor_mesh(1e-3 * k).positions);
    run(simulation, 1);
  }
  for (const Vec3& x : simulation.positions(cloth)) EXPECT_GT(x.z(), 0.02);
  EXPECT_NE(refusal([&] {
              simulation.deform(floor, floor_mesh(0).positions);
              simulation.deform(floor, std::vector<Vec3>(3));
            }).find("3 found, one for each of the 4 vertices was expected"),
            std::string::npos);
}

TEST(Controls, AnotherMaterialHangsDeeper) {
  HangingSheet sheet;
  World world;
  const ClothHandle cloth = world.add_cloth(sheet.world.cloths()[0]);
  world.pin(cloth, {0, 8});
  Simulation simulation(world);
  run(simulation, 150);
  const double stiff = simulation.worst_stretch().stretch;
  SpringMaterial soft = world.cloths()[0].material;
  soft.k_stretch = 60;
  simulation.set_material(cloth, soft);
  EXPECT_EQ(simulation.world().cloths()[0].material.k_stretch, 60);
  run(simulation, 150);
  EXPECT_GT(simulation.worst_stretch().stretch, 3 * stiff);
}

TEST(Controls, StepsMayHaveAnyLength) {
  HangingSheet sheet;
  Simulation simulation(sheet.world);
  double time = 0.0;
  for (const double step : {5e-3, 1e-3, 1e-3, 8e-3, 2e-3}) {
    run(simulation, 1, step);
    time += step;
    EXPECT_NEAR(simulation.time(), time, 1e-15);
  }
  EXPECT_EQ(simulation.steps_done(), 5);
  for (const double wrong : {-1e-3, 0.0, 1.0, std::nan("")})
    EXPECT_NE(refusal([&] { simulation.step(wrong); }).find("step = "), std::string::npos);
  EXPECT_EQ(simulation.steps_done(), 5);
}

TEST(Controls, SayWhatDoesNotFit) {
  HangingSheet sheet;
  Simulation simulation(sheet.world);
  const std::vector<Vec3> three(3, Vec3::Zero());
  const auto says = [](const std::string& text, const char* words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  says(refusal([&] { simulation.positions({5}); }), "there is no cloth of handle 5");
  says(refusal([&] { simulation.move(PinHandle{-1}, Vec3::Zero()); }), "there is no pin of handle");
  says(refusal([&] { simulation.move(SolidHandle{3}, Pose()); }), "there is no solid of handle 3");
  says(refusal([&] { simulation.set_velocities(sheet.sheet, three); }), "velocities: 3 found");
  says(refusal([&] { simulation.set_forces(sheet.sheet, three); }), "forces: 3 found");
  says(refusal([&] { simulation.place(sheet.pin, three); }), "places: 3 found");
  says(refusal([&] { simulation.pin(sheet.sheet, {81}); }), "are 0 to 80");
  says(refusal([&] { simulation.pin(sheet.sheet, {}); }), "no nodes given");
  says(refusal([&] { simulation.deform(sheet.ball, three); }), "is no mesh");
  says(refusal([&] { simulation.set_gravity(Vec3(0, 0, NAN)); }), "gravity = nan");
  says(refusal([&] { simulation.set_wind({.gust = -1}); }), "wind.gust = -1");
  says(refusal([&] { simulation.set_material(sheet.sheet, {.k_stretch = -5}); }),
       "cloth.0.k_stretch = -5 N/m is out of range");
}

}  // namespace
}  // namespace taut::test
