// The simulation loop on small scenes: the same bits for any thread count, energy, going on from a
// checkpoint, a solver that fails.

#include "taut/scene/scene_simulation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/contact/solid_contact.h"
#include "taut/scene/scene_file.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/simulation_state.h"
#include "taut/sim/surface_contact.h"
#include "taut/solve/solver.h"
#include "taut/step/state.h"
#include "taut/step/stepper.h"

namespace taut {
namespace {

Scene scene_of(const std::string& text, std::vector<std::string> settings = {}) {
  return read_scene_text(text, "/scenes/test.toml", settings);
}

// A sheet that falls on a sphere with friction, and a flying ball of another friction that hits it
// from the side.
const std::string crowded = R"(
[time]
step = 4e-3
max_halvings = 1
[[cloth]]
grid = { nodes = [41, 40], origin = [-0.3, -0.3, 0.205], u = [0.6, 0, 0], v = [0, 0.6, 0] }
density = 0.15
k_stretch = 800
drag = 2e-5
wind_pressure = 0.2
jitter = 1e-4
[wind]
velocity = [0.5, 0, 0]
[[solid]]
shape = "sphere"
radius = 0.2
friction = 0.3
thickness = 1e-3
[[solid]]
shape = "sphere"
radius = 0.1
translation = [0, -0.47, 0.2]
velocity = [0, 5, 0]
friction = 0.1
)";

struct Outcome {
  State state;
  ContactState contacts;
  int most_contacts = 0, sliding = 0;
};

Outcome simulate(const Scene& scene, int steps) {
  SceneSimulation simulation(scene);
  Outcome outcome;
  StepReport record;
  for (int k = 0; k < steps; ++k) {
    const Status status = simulation.step(record);
    EXPECT_TRUE(status.ok()) << status.message;
    outcome.most_contacts = std::max(outcome.most_contacts, record.contacts);
    outcome.sliding += static_cast<int>(
        std::ranges::count(simulation.contact().state().sticking, 0, &ContactStick::sticks));
  }
  outcome.state = simulation.state();
  outcome.contacts = simulation.contact().state();
  return outcome;
}

void expect_same(const State& a, const State& b, const std::string& what) {
  EXPECT_TRUE(a.x == b.x && a.v == b.v && a.x_prev == b.x_prev && a.v_prev == b.v_prev &&
              a.last == b.last && a.time == b.time && a.has_previous == b.has_previous)
      << what;
}

TEST(Simulation, DeterministicForAnyNumberOfThreads) {
  const int usual = thread_count();
  for (const char* variant :
       {"time.integrator=\"semi_implicit_euler\"", "time.integrator=\"bdf2\""}) {
    const Scene scene = scene_of(crowded, {variant, "solver.name=\"core_pcg:block\""});
    Outcome first;
    for (const int threads : {1, 2, 4}) {
      set_thread_count(threads);
      const Outcome outcome = simulate(scene, 18);
      if (threads == 1) {
        first = outcome;
        EXPECT_GT(outcome.most_contacts, 30);
        EXPECT_GT(outcome.sliding, 30) << "no friction: the test says little";
      }
      expect_same(outcome.state, first.state,
                  std::string(variant) + ", " + std::to_string(threads) + " threads");
      EXPECT_TRUE(outcome.contacts == first.contacts);
    }
  }
  set_thread_count(usual);
}

// What goes on from a checkpoint ends in the same bits as what was never interrupted.
struct Interrupted {
  const char* integrator;
  const char* solver;
  int at;
};

TEST(Simulation, GoesOnFromASnapshotToTheSameBits) {
  // `auto`: while it tries its methods for the first time, and later.
  for (const auto& [integrator, solver, at] :
       {Interrupted{"time.integrator=semi_implicit_euler", "solver.name=core_pcg:block", 20},
        Interrupted{"time.integrator=bdf2", "solver.name=core_pcg:block", 20},
        Interrupted{"time.integrator=semi_implicit_euler", "solver.name=auto", 2},
        Interrupted{"time.integrator=semi_implicit_euler", "solver.name=auto", 20},
        Interrupted{"time.integrator=newton", "solver.name=auto", 20},
        Interrupted{"time.integrator=bdf2", "solver.name=auto", 23}}) {
    const Scene scene = scene_of(crowded, {integrator, solver, "cloth.grid.nodes=[21, 20]"});
    SCOPED_TRACE(fmt::format("{}, {}, step {}", integrator, solver, at));
    SceneSimulation whole(scene), resumed(scene);
    StepReport record;
    Snapshot snapshot;
    for (int k = 0; k < 40; ++k) {
      if (k == at) {
        EXPECT_GE(whole.contact().contacts(), k < 10 ? 0 : 5);
        snapshot = whole.save();
      }
      ASSERT_TRUE(whole.step(record).ok());
    }
    resumed.load(snapshot);
    for (int k = at; k < 40; ++k) ASSERT_TRUE(resumed.step(record).ok());
    EXPECT_EQ(resumed.steps_done(), 40);
    expect_same(resumed.state(), whole.state(), integrator);
    EXPECT_TRUE(resumed.contact().state() == whole.contact().state());
    EXPECT_EQ(resumed.stepper().solver().memory(), whole.stepper().solver().memory());
    if (scene.solver.name == "auto") {
      EXPECT_NE(state_from(snapshot.bytes, "it").solver_memory, make_solver(scene.solver)->memory())
          << "there was nothing to remember";
    }
  }
}

const std::string pinned = R"(
[time]
step = 5e-3
[[cloth]]
grid = { nodes = [13, 13], origin = [-0.5, -0.5, 1.0], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.15
k_stretch = 400
k_damp_stretch = 0.02
drag = 1e-3
[[cloth.pin]]
corners = ["u0v0", "u1v0", "u0v1", "u1v1"]
)";

// Drag takes away kinetic energy at c/m = 1.1/s, semi-implicit Euler's own damping much more. BDF2
// with springs that go slack (compression "none") is not dissipative: its single linearised solve
// misjudges springs that go taut within the step. Here energy rises by up to 5 % of all that is
// lost in a step of 5 ms, 0.3 % in one of 1 ms; so it is tested on springs that push back.
struct Decay {
  std::vector<std::string> settings;
  double calm;  // kinetic energy after six seconds, of its maximum
};

TEST(Simulation, EnergyOfADampedSheetDecays) {
  for (const Decay& decay : {Decay{{"time.integrator=semi_implicit_euler"}, 1e-5},
                             Decay{{"time.integrator=bdf2", "cloth.compression=linear"}, 5e-3}}) {
    std::vector<std::string> settings = decay.settings;
    settings.push_back("solver.tolerance=1e-8");
    const std::string& integrator = settings.front();
    const Scene scene = scene_of(pinned, settings);
    SceneSimulation simulation(scene);
    StepReport record;
    const auto height_energy = [&] {
      double sum = 0.0;
      for (Index i = 0; i < simulation.cloth().nodes(); ++i)
        sum -=
            simulation.cloth().external().masses()[i] * scene.gravity.dot(simulation.state().x[i]);
      return sum;
    };
    const double start = height_energy();
    double before = start, largest_rise = 0.0, fastest = 0.0;
    for (int k = 0; k < 1200; ++k) {
      ASSERT_TRUE(simulation.step(record).ok());
      const double energy = record.kinetic_J + record.elastic_J + height_energy();
      largest_rise = std::max(largest_rise, energy - before);
      fastest = std::max(fastest, record.kinetic_J);
      before = energy;
    }
    const double lost = start - before;
    EXPECT_GT(lost, 0.05) << "it sagged by some centimetres: " << lost << " J";
    EXPECT_GT(fastest, 0.01);
    EXPECT_LT(record.kinetic_J, decay.calm * fastest) << integrator << ": calm after six seconds";
    // The step is linearised, so that it may rise a little now and then.
    EXPECT_LT(largest_rise, 2e-3 * lost) << integrator;
    EXPECT_LT(record.max_stretch, 0.2);
    EXPECT_GT(record.max_stretch, 0.0);
  }
}

TEST(Simulation, ASolverThatGivesUpIsReplacedForThatSolveAndCounted) {
  const Scene good = scene_of(pinned, {"solver.name=\"mpcg\"", "solver.tolerance=1e-10"});
  Scene bad = good;
  bad.solver.max_iterations = 1;
  SceneSimulation reference(good), simulation(bad);
  StepReport record;
  for (int k = 0; k < 10; ++k) {
    ASSERT_TRUE(reference.step(record).ok());
    EXPECT_EQ(record.fallbacks, 0);
    EXPECT_TRUE(record.solver.starts_with("mpcg")) << record.solver;
    ASSERT_TRUE(simulation.step(record).ok());
    // Flat and at rest the sheet has only one motion, which mpcg finds at once.
    if (k == 0) continue;
    EXPECT_EQ(record.fallbacks, 1) << "step " << k + 1;
    EXPECT_FALSE(record.solver.starts_with("mpcg")) << record.solver;
  }
  for (Index i = 0; i < simulation.cloth().nodes(); ++i)
    EXPECT_LT((simulation.state().x[i] - reference.state().x[i]).norm(), 1e-6)
        << "the direct method gives the same motion";
}

void set_state(Simulation& simulation, const State& state) {
  SimulationState whole = simulation.full_state();
  whole.state = state;
  simulation.set_full_state(whole);
}

// A sheet that spins about one held corner, 0.4 rad a step.
const std::string spinning = R"(
gravity = [0, 0, 0]
[time]
step = 4e-3
[[cloth]]
grid = { nodes = [6, 6], u = [0.1, 0, 0], v = [0, 0.1, 0] }
node_mass = 1e-4
k_stretch = 2000
compression = "linear"
[[cloth.pin]]
nodes = [0]
)";

State spin(const Scene& scene, int steps, std::vector<StepReport>& records) {
  SceneSimulation simulation(scene);
  State state = simulation.state();
  for (std::size_t i = 0; i < state.x.size(); ++i) state.v[i] = Vec3(0, 0, 100).cross(state.x[i]);
  set_state(simulation, state);
  records.assign(static_cast<std::size_t>(steps), {});
  for (StepReport& record : records) {
    const Status status = simulation.step(record);
    EXPECT_TRUE(status.ok()) << status.message;
  }
  return simulation.state();
}

TEST(Simulation, StepsThatOvershootAreHalved) {
  std::vector<StepReport> whole, halved;
  spin(scene_of(spinning, {"time.max_halvings=0"}), 1, whole);
  spin(scene_of(spinning, {"time.max_halvings=6", "time.overshoot_limit=0.01"}), 1, halved);
  EXPECT_EQ(whole[0].retries, 0);
  EXPECT_GT(whole[0].max_stretch, 0.06) << "a step as long as that stretches what only turns";
  // One turn of 0.4 rad lengthens by 1/cos - 1 = 8 %, one of 0.1 rad by 0.5 %.
  EXPECT_GE(halved[0].retries, 3) << "the whole and both its halves are too long";
  EXPECT_LE(halved[0].retries, 7);
  EXPECT_LT(halved[0].max_stretch, 0.02);
  EXPECT_EQ(halved[0].time, whole[0].time);
}

// Of a step cut in two, each half is a whole step of half the length. BDF2 starts afresh with each
// of them, which makes it Euler's method.
TEST(Simulation, HalvesAreStepsOfHalfTheLength) {
  for (const char* integrator : {"semi_implicit_euler", "bdf2"}) {
    std::vector<StepReport> halved, half;
    const State a = spin(scene_of(spinning, {"time.overshoot_limit=0", "time.max_halvings=1",
                                             "solver.tolerance=1e-12",
                                             fmt::format("time.integrator=\"{}\"", integrator)}),
                         6, halved);
    const State b = spin(
        scene_of(spinning, {"time.max_halvings=0", "time.step=2e-3", "solver.tolerance=1e-12"}), 12,
        half);
    for (const StepReport& record : halved) ASSERT_EQ(record.retries, 1);
    for (std::size_t i = 0; i < a.x.size(); ++i)
      ASSERT_LT((a.x[i] - b.x[i]).norm(), 1e-9) << integrator << ", node " << i;
  }
  std::vector<StepReport> records;
  EXPECT_FALSE(spin(scene_of(spinning, {"time.overshoot_limit=0", "time.max_halvings=1",
                                        "time.integrator=\"bdf2\""}),
                    1, records)
                   .has_previous)
      << "the next step is longer than the last";
}

TEST(Simulation, AStepThatCannotBeSolvedLeavesTheStateAsItWas) {
  Scene scene = scene_of(spinning);
  SceneSimulation simulation(scene);
  State state = simulation.state();
  state.v[7] = Vec3(1e200, 0, 0);  // its square is not a number that a solver can hold
  set_state(simulation, state);
  StepReport record;
  const Status status = simulation.step(record);
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.message.find("step 1"), std::string::npos) << status.message;
  EXPECT_NE(status.message.find("also with steps of 0.00025 s"), std::string::npos)
      << status.message;
  EXPECT_EQ(record.retries, 4);
  expect_same(simulation.state(), state, "after the failed step");
  EXPECT_EQ(simulation.steps_done(), 0);
}

// A slack sheet in free flight whose shear springs are too stiff for an explicit step: h² k_shear/m
// = 11.
TEST(Simulation, AdaptiveImexHoldsWhereImexExplodes) {
  const auto kinetic = [](const char* integrator) {
    SceneSimulation simulation(
        scene_of("gravity = [0, 0, 0]\n[time]\nstep = 6e-3\novershoot_limit = 1e6\n[[cloth]]\ngrid "
                 "= { nodes = [9, 9], u = [0.1, 0, 0], v "
                 "= [0, 0.1, 0] }\nnode_mass = 9.5e-6\nk_stretch = 60\nk_shear = 3\nk_bend = "
                 "0.01\ncompression = "
                 "\"linear\"\njitter = 1e-4\n",
                 {std::string("time.integrator=\"") + integrator + "\"", "contact.self=false"}));
    StepReport record;
    double largest = 0.0;
    for (int k = 0; k < 200 && simulation.step(record).ok() && largest < 1.0; ++k)
      largest = std::max(largest, record.kinetic_J);
    return largest;
  };
  EXPECT_GT(kinetic("imex"), 0.1);
  EXPECT_LT(kinetic("imex_adaptive"), 1e-4);
}

// Pins carried along key frames: linear in between, exactly there at every step.
TEST(Simulation, PinsFollowTheirPathsExactly) {
  for (const char* integrator : {"semi_implicit_euler", "imex", "bdf2"}) {
    const Scene scene = scene_of(
        pinned +
            R"(key_frames = [ { time = 0, translation = [0, 0, 0] }, { time = 0.1, translation = [0.1, 0, 0.2] },
                                 { time = 0.2, translation = [0.1, 0.3, 0] } ]
)",
        {"time.integrator=\"" + std::string(integrator) + "\"", "time.step=2e-3"});
    SceneSimulation simulation(scene);
    const std::vector<Vec3> start = simulation.state().x;
    StepReport record;
    for (int k = 1; k <= 120; ++k) {
      ASSERT_TRUE(simulation.step(record).ok());
      const double t = 2e-3 * k;
      const double first = std::min(1.0, t / 0.1), second = std::clamp((t - 0.1) / 0.1, 0.0, 1.0);
      const Vec3 moved = first * Vec3(0.1, 0, 0.2) + second * Vec3(0, 0.3, -0.2);
      for (const Index node : {0, 12, 156, 168})
        ASSERT_LT((simulation.state().x[node] - start[node] - moved).norm(), 1e-14)
            << integrator << ", step " << k;
      ASSERT_EQ(record.constraints, 12);
      ASSERT_EQ(record.dof, 3 * 169 - 12);
    }
  }
}

TEST(Simulation, ReleasedPinsLetGo) {
  const Scene scene = scene_of(pinned + "release = 0.05\n");
  SceneSimulation simulation(scene);
  StepReport record;
  std::vector<Index> constraints;
  for (int k = 0; k < 15; ++k) {
    ASSERT_TRUE(simulation.step(record).ok());
    constraints.push_back(record.constraints);
  }
  EXPECT_EQ(constraints,
            (std::vector<Index>{12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace taut
