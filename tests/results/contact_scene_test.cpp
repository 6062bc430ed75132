// Short forms of the contact scenes: every few steps another library (CGAL) judges whether anything
// intersects, and contact must really have happened.

#include <gtest/gtest.h>

#include "contact/independent_judge.h"
#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/constraint/constraint_set.h"
#include "taut/contact/solid_contact.h"
#include "taut/results/checkpoint.h"
#include "taut/scene/scene_file.h"
#include "taut/scene/scene_simulation.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/simulation_state.h"
#include "taut/sim/surface_contact.h"
#include "taut/solve/linear_system.h"
#include "taut/step/state.h"
#include "taut/step/stepper.h"

namespace taut {
namespace {

Scene shipped(const std::string& name, const std::vector<std::string>& settings) {
  return read_scene(std::string(TAUT_SOURCE_DIR) + "/scenes/" + name + ".toml", settings);
}

std::vector<std::array<Index, 2>> judged(const SceneSimulation& simulation) {
  const SurfaceContact& contact = *simulation.surface_contact();
  const CollisionSurface& surface = contact.contact().surface();
  const std::vector<Vec3> x = contact.positions(simulation.state().time, simulation.state().x);
  return test::intersecting_triangles(x, surface.triangles, surface.is_solid);
}

struct ShortForm {
  std::string scene;
  std::vector<std::string> settings;
  int steps, judge_every;
  int least_pairs;    // that push at once
  double zone_share;  // of node-steps, at most
};

void PrintTo(const ShortForm& form, std::ostream* out) { *out << form.scene; }

class ContactScene : public testing::TestWithParam<ShortForm> {};

TEST_P(ContactScene, NothingEverIntersects) {
  if (!test::judge_available()) GTEST_SKIP() << test::no_judge;
  const ShortForm& form = GetParam();
  SceneSimulation simulation(shipped(form.scene, form.settings));
  ASSERT_TRUE(judged(simulation).empty()) << "at the start";
  int most_pairs = 0;
  double zone_steps = 0.0;
  for (int k = 1; k <= form.steps; ++k) {
    StepReport record;
    const Status status = simulation.step(record);
    ASSERT_TRUE(status.ok()) << status.message;
    ASSERT_EQ(record.intersections, 0) << "by Taut's own check, step " << k;
    most_pairs = std::max(most_pairs, record.pushing_pairs);
    zone_steps += record.zone_nodes;
    if (k % form.judge_every == 0) {
      ASSERT_TRUE(judged(simulation).empty()) << "step " << k;
    }
  }
  EXPECT_GE(most_pairs, form.least_pairs);
  EXPECT_LE(zone_steps / form.steps / simulation.cloth().nodes(), form.zone_share);
}

const ShortForm short_forms[] = {
    {"clump", {"cloth.grid.nodes=[25,25]"}, 260, 10, 300, 0.05},
    {"stack", {"cloth.grid.nodes=[11,11]"}, 80, 5, 300, 0.05},
    {"pinch", {"cloth.grid.nodes=[17,17]"}, 120, 5, 20, 0.05},
    {"twist", {"cloth.tube.nodes=[24,24]"}, 300, 10, 100, 0.05},
    {"tshirt_cylinder", {"cloth.1.grid.nodes=[15,15]"}, 60, 10, 100, 0.05},
};
INSTANTIATE_TEST_SUITE_P(Shipped, ContactScene, testing::ValuesIn(short_forms),
                         [](const auto& form) { return form.param.scene; });

struct End {
  State state;
  ClothContactState contact;
};

End run(const Scene& scene, int steps) {
  SceneSimulation simulation(scene);
  StepReport record;
  for (int k = 0; k < steps; ++k) EXPECT_TRUE(simulation.step(record).ok());
  EXPECT_GT(record.pushing_pairs, 0);
  return {simulation.state(), simulation.surface_contact()->state()};
}

// With no impulses at all, everything that collides is a zone.
const std::vector<std::string> zones_only{"cloth.grid.nodes=[17,17]", "contact.sweeps=0"};

TEST(ContactSimulation, SameBitsForAnyNumberOfThreads) {
  const Scene scene = shipped("clump", {"cloth.grid.nodes=[31,31]"});
  const int usual = thread_count();
  set_thread_count(1);
  const End one = run(scene, 160);
  set_thread_count(4);
  const End four = run(scene, 160);
  set_thread_count(usual);
  EXPECT_EQ(one.state.x, four.state.x);
  EXPECT_EQ(one.state.v, four.state.v);
}

TEST(ContactSimulation, ResumesToTheSameBitsInTheMidstOfZones) {
  const Scene scene = shipped("clump", zones_only);
  SceneSimulation simulation(scene);
  StepReport record;
  int steps = 0;
  while (simulation.surface_contact()->state().zones.node.empty() && ++steps < 300)
    ASSERT_TRUE(simulation.step(record).ok());
  ASSERT_LT(steps, 300) << "no zone was ever kept";
  EXPECT_GT(record.zone_nodes, 0);
  SceneSimulation resumed(scene);
  resumed.load(simulation.save());
  SceneSimulation forgetful(scene);
  SimulationState without_zones = simulation.full_state();
  without_zones.surface_contact = {};
  forgetful.set_full_state(without_zones);
  bool zones_matter = false;
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(simulation.step(record).ok());
    ASSERT_TRUE(resumed.step(record).ok());
    ASSERT_TRUE(forgetful.step(record).ok());
    zones_matter |= forgetful.state().x != simulation.state().x;
  }
  EXPECT_EQ(resumed.state().x, simulation.state().x);
  EXPECT_EQ(resumed.state().v, simulation.state().v);
  EXPECT_TRUE(zones_matter) << "the test would not have noticed that zones were lost";
}

// What pushes a pair is where the next step begins.
TEST(ContactSimulation, ResumesToTheSameBitsInAHeap) {
  const Scene scene = shipped("clump", {"cloth.grid.nodes=[25,25]"});
  SceneSimulation simulation(scene);
  StepReport record;
  for (int k = 0; k < 200; ++k) ASSERT_TRUE(simulation.step(record).ok());
  const ClothContactState& contact = simulation.surface_contact()->state();
  ASSERT_GT(contact.forces.size(), 100u);
  SceneSimulation resumed(scene), forgetful(scene);
  resumed.load(simulation.save());
  SimulationState without_forces = simulation.full_state();
  without_forces.surface_contact.forces.clear();
  forgetful.set_full_state(without_forces);
  for (SceneSimulation* s : {&simulation, &resumed, &forgetful}) ASSERT_TRUE(s->step(record).ok());
  EXPECT_EQ(resumed.state().x, simulation.state().x);
  EXPECT_EQ(resumed.state().v, simulation.state().v);
  EXPECT_EQ(resumed.surface_contact()->state(), simulation.surface_contact()->state());
  EXPECT_NE(forgetful.state().x, simulation.state().x)
      << "the test would not have noticed that forces were lost";
}

TEST(ContactSimulation, NodesOfZonesAreEliminatedInTheNextStep) {
  SceneSimulation simulation(shipped("clump", zones_only));
  StepReport record;
  int steps = 0;
  while (simulation.surface_contact()->state().zones.node.empty() && ++steps < 300)
    ASSERT_TRUE(simulation.step(record).ok());
  ASSERT_LT(steps, 300);
  const std::vector<Index> held = simulation.surface_contact()->state().zones.node;
  int eliminated = -1;
  simulation.on_solved = [&](const SolveSummary&) {
    eliminated = 0;
    for (const Index node : held) eliminated += simulation.constraints().ndof(node) == 0;
  };
  ASSERT_TRUE(simulation.step(record).ok());
  EXPECT_EQ(eliminated, static_cast<int>(held.size()));
  for (const Index node : held)
    EXPECT_EQ(std::ranges::count(simulation.surface_contact()->state().zones.node, node), 0)
        << "held twice in a row";
}

const std::string thrown = R"(
gravity = [0, 0, 0]
[time]
step = 4e-3
[[cloth]]
name = "low"
grid = { nodes = [13, 13], origin = [-0.1, -0.1, 0], u = [0.2, 0, 0], v = [0, 0.2, 0] }
velocity = [0.4, 0, 2]
density = 0.15
jitter = 5e-4
[[cloth]]
name = "high"
grid = { nodes = [11, 11], origin = [-0.02, -0.05, 0.02], u = [0.15, 0.03, 0], v = [-0.03, 0.15, 0.02] }
velocity = [0, 0, -1]
density = 0.3
jitter = 5e-4
)";

// Of the velocities that the integrator goes on with.
struct Momentum {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  double linear_scale = 0.0, angular_scale = 0.0;
};

Momentum momentum(std::span<const double> mass, std::span<const Vec3> x, std::span<const Vec3> v) {
  Momentum m;
  for (std::size_t i = 0; i < x.size(); ++i) {
    m.linear += mass[i] * v[i];
    m.angular += mass[i] * x[i].cross(v[i]);
    m.linear_scale += mass[i] * v[i].norm();
    m.angular_scale += mass[i] * x[i].norm() * v[i].norm();
  }
  return m;
}

// Two sheets thrown at each other where there is nothing else: whatever the response does in a
// step, it neither pushes nor turns the whole.
TEST(ContactSimulation, ResponseKeepsTheMomentumOfAnIsolatedClump) {
  SceneSimulation simulation(read_scene_text(thrown, "/scenes/test.toml", {}));
  const auto mass = simulation.cloth().external().masses();
  std::vector<Vec3> x0, x_solved, v_solved;
  simulation.on_solved = [&](const SolveSummary&) {
    x0 = simulation.state().x;
    x_solved.assign(simulation.stepper().x_end().begin(), simulation.stepper().x_end().end());
    v_solved.assign(simulation.stepper().v_end().begin(), simulation.stepper().v_end().end());
  };
  int impacts = 0, steps_moved = 0;
  for (int k = 0; k < 40; ++k) {
    StepReport record;
    ASSERT_TRUE(simulation.step(record).ok());
    impacts += record.impacts;
    if (record.retries > 0) continue;  // then on_solved saw another step than the last
    const State& end = simulation.state();
    steps_moved += end.x != x_solved;
    const double h = simulation.scene().time.step;
    for (std::size_t i = 0; i < x0.size(); ++i)
      ASSERT_LT((x0[i] + h * end.v[i] - end.x[i]).norm(), 1e-13);
    const Momentum before = momentum(mass, x0, v_solved), after = momentum(mass, x0, end.v),
                   at_end = momentum(mass, end.x, end.v);
    EXPECT_LE((after.linear - before.linear).norm(), 1e-10 * before.linear_scale) << "step " << k;
    EXPECT_LE((after.angular - before.angular).norm(), 1e-10 * before.angular_scale)
        << "step " << k;
    EXPECT_LE((at_end.angular - before.angular).norm(), 1e-10 * before.angular_scale)
        << "about the new positions, step " << k;
  }
  EXPECT_GT(impacts, 100);
  EXPECT_GT(steps_moved, 10);
}

// An integrator of second order does not end with the velocity that its way took.
TEST(ContactSimulation, ResponseKeepsMomentumWhateverTheVelocityAtTheEnd) {
  SceneSimulation simulation(read_scene_text(thrown, "/scenes/test.toml", {}));
  const auto mass = simulation.cloth().external().masses();
  const double h = 0.02;
  const State& start = simulation.state();
  std::vector<Vec3> x_end(start.x.size()), v_end(start.x.size());
  for (std::size_t i = 0; i < x_end.size(); ++i) {
    x_end[i] = start.x[i] + h * start.v[i];
    v_end[i] = 0.8 * start.v[i] + Vec3(3, -2, 4).cross(start.x[i]);
  }
  ConstraintSet pins;
  pins.reset(simulation.cloth().nodes());
  std::vector<Vec3> x = x_end, v = v_end;
  bool changed = false;
  SurfaceContact& contact = *simulation.surface_contact();
  const Status status =
      contact.correct(0.0, h, start.x, v_end, pins, simulation.contact(), x, changed);
  ASSERT_TRUE(status.ok()) << status.message;
  ASSERT_TRUE(changed);
  ASSERT_EQ(contact.counts().zones, 0);
  for (std::size_t i = 0; i < x.size(); ++i) v[i] += (x[i] - x_end[i]) / h;
  const Momentum before = momentum(mass, x_end, v_end), after = momentum(mass, x, v);
  EXPECT_LE((after.linear - before.linear).norm(), 1e-10 * before.linear_scale);
  EXPECT_LE((after.angular - before.angular).norm(), 1e-10 * before.angular_scale);
}

const std::string crossed = R"(
[time]
step = 4e-3
[[cloth]]
name = "flat"
grid = { nodes = [5, 5], origin = [-0.1, -0.1, 0], u = [0.2, 0, 0], v = [0, 0.2, 0] }
density = 0.15
[[cloth]]
name = "upright"
grid = { nodes = [5, 5], origin = [-0.11, 0.01, -0.1], u = [0.2, 0, 0], v = [0, 0.005, 0.2] }
density = 0.15
)";

TEST(ContactSimulation, AStartWithIntersectionsIsRefusedWithTheirPlaces) {
  try {
    SceneSimulation simulation(read_scene_text(crossed, "/scenes/test.toml", {}));
    FAIL() << "not refused";
  } catch (const InputError& error) {
    const std::string text = error.what();
    for (const char* part :
         {"cloth 'flat'", "cloth 'upright'", "the triangle", "contact.allow_intersections"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  SceneSimulation allowed(read_scene_text(
      crossed, "/scenes/test.toml", std::vector<std::string>{"contact.allow_intersections=true"}));
  SceneSimulation without(read_scene_text(crossed, "/scenes/test.toml",
                                          std::vector<std::string>{"contact.self=false"}));
  EXPECT_EQ(without.surface_contact(), nullptr);
}

// Two plates press a sheet flat: there is no way out, and the run must say so and keep the last
// good state.
TEST(ContactSimulation, StopsWhereClothIsCrushedAndNamesThePlace) {
  Scene scene = shipped("pinch", {"cloth.grid.nodes=[13,13]", "contact.thickness=1e-3"});
  for (Solid& solid : scene.solids) {
    const double side = solid.name == "upper roller" ? 1.0 : -1.0;
    solid.key_frames = {{0.0, {Eigen::Quaterniond::Identity(), Vec3(0, 0, 0.065 * side)}},
                        {0.2, {Eigen::Quaterniond::Identity(), Vec3(0, 0, 0.05 * side)}}};
  }
  SceneSimulation simulation(scene);
  Status status;
  StepReport record;
  double good_time = 0.0;
  for (int k = 0; k < 80 && status.ok(); ++k) {
    good_time = simulation.state().time;
    status = simulation.step(record);
  }
  ASSERT_FALSE(status.ok());
  for (const char* part : {"step ", "cloth 'sheet' node", "upper roller", "lower roller"})
    EXPECT_NE(status.message.find(part), std::string::npos) << status.message;
  EXPECT_NEAR(simulation.state().time, good_time, 1e-12);
  EXPECT_TRUE(simulation.surface_contact() && judged(simulation).empty());
  const double gap = 2 * (0.065 - 0.015 * good_time / 0.2) - 2 * 0.06;
  EXPECT_LT(gap, 2e-3) << "stopped although there was room";
}

}  // namespace
}  // namespace taut
