// `solver.name = "auto"` in scenes: every regime of step size and stiffness is solved, to the
// accuracy asked for, within the core's bound.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "taut/scene/scene_file.h"
#include "taut/scene/scene_simulation.h"
#include "taut/solve/linear_system.h"
#include "taut/solve/reference.h"
#include "taut/step/stepper.h"

namespace taut {
namespace {

const std::string ball = R"(
[[cloth]]
grid = { nodes = [17, 17], origin = [-0.2, 0, 0], u = [0.4, 0, 0], v = [0, 0, 0.4] }
node_mass = 4e-5
compression = "linear"
drag = 1e-6
pin = [{ corners = ["u0v1", "u1v1"] }]
[[solid]]
shape = "sphere"
radius = 0.08
translation = [0, -0.1, 0.2]
velocity = [0, 2, 0]
friction = 0.3
thickness = 1e-3
)";

TEST(AutoScene, SolvesEveryRegime) {
  constexpr double tolerance = 1e-4;
  int contacts = 0, with_bound = 0;
  for (const double h : {1e-3, 3.67e-3, 16.7e-3, 33e-3})
    for (const auto& [k_shear, k_bend] :
         {std::pair{0.3, 0.05}, std::pair{30.0, 5.0}, std::pair{600.0, 50.0}})
      for (const double k_stretch : {60.0, 6e3, 6e6}) {
        const std::string setting =
            fmt::format("h {}, shear {}, stretch {}", h, k_shear, k_stretch);
        SCOPED_TRACE(setting);
        const Scene scene = read_scene_text(
            ball, "/scenes/test.toml",
            std::vector<std::string>{fmt::format("time.step={}", h), "time.max_halvings=0",
                                     fmt::format("cloth.k_shear={}", k_shear),
                                     fmt::format("cloth.k_bend={}", k_bend),
                                     fmt::format("cloth.k_stretch={}", k_stretch),
                                     fmt::format("solver.tolerance={}", tolerance)});
        EXPECT_EQ(scene.solver.name, "auto") << "the default";
        SceneSimulation simulation(scene);
        double error = 0.0, solved_stiffness = 0.0;
        simulation.on_solved = [&](const SolveSummary&) {
          const LinearSystem system = simulation.stepper().system();
          solved_stiffness = system.stiffness;
          error =
              anorm_error(system, flat(simulation.stepper().unknown()), reference_solution(system));
        };
        for (int step = 0; step < 12; ++step) {
          StepReport record;
          const Status status = simulation.step(record);
          ASSERT_TRUE(status.ok()) << status.message;
          EXPECT_LT(error, 10.0 * tolerance) << record.solver << ", step " << step;
          // The residual's own norm can be larger than the error's by sqrt(cond(A)), and is where
          // rounded springs pull across: a twentieth of that is seen.
          const double most_residual =
              tolerance * std::max(100.0, 0.1 * std::sqrt(solved_stiffness));
          EXPECT_LT(record.relative_residual, most_residual) << record.solver << ", step " << step;
          if (record.solver.starts_with("core") &&
              (record.contact_passes == 1 || record.bound_iterations >= 0)) {
            EXPECT_LE(record.iterations, record.bound_iterations);
            if (h > 1e-3 || k_stretch > 60.0) {
              EXPECT_GT(record.core_springs, 0);
            }
            ++with_bound;
          }
          if (h * h * k_stretch < 1e8 * 4e-5) {
            EXPECT_EQ(record.fallbacks, 0);  // beyond, single precision may not do
          }
          contacts += record.contacts;
        }
      }
  EXPECT_GT(with_bound, 50);
  EXPECT_GT(contacts, 100) << "the ball never arrives";
}

TEST(AutoScene, TheCoreIsASettingOfItsOwn) {
  const auto springs = [](const char* setting) {
    SceneSimulation simulation(read_scene_text(
        ball, "/scenes/test.toml",
        std::vector<std::string>{"solver.name=core_pcg:block", "cloth.k_shear=300", setting}));
    StepReport record;
    EXPECT_TRUE(simulation.step(record).ok());
    EXPECT_LE(record.iterations, record.bound_iterations);
    return record.core_springs;
  };
  const Index stretch = 2 * 17 * 16, shear = 2 * 16 * 16;
  EXPECT_EQ(springs("solver.core=stretch"), stretch);
  EXPECT_EQ(springs("solver.core=auto"), stretch + shear);
  EXPECT_EQ(springs("title=by default"), stretch);
}

}  // namespace
}  // namespace taut
