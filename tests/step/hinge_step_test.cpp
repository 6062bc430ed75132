// Steps of a sheet with bending hinges: the cores that the stepper hands on, and that all solvers
// take the sheet the same way.

#include <gtest/gtest.h>

#include "core/hinged_sheet.h"
#include "taut/solve/reference.h"
#include "taut/step/stepper.h"

namespace taut::test {
namespace {

struct HingedRun {
  HingedSheet sheet;
  State state;
  ConstraintSet constraints;

  explicit HingedRun(double k_bend) : sheet({.k_bend = k_bend, .nu = 7, .nv = 6}) {
    Random random(1);
    state.x = sheet.rest.positions;
    for (Vec3& place : state.x) place += 0.1 * sheet.material.spacing * random.direction();
    state.v.assign(state.x.size(), Vec3::Zero());
    constraints.reset(sheet.nodes());
    constraints.fix(0, Vec3::Zero());
    constraints.fix(6, Vec3::Zero());
  }
  Stepper stepper(const std::string& solver, IntegratorKind integrator) const {
    SolverOptions options;
    options.name = solver, options.tolerance = 1e-9;
    return Stepper(sheet.nodes(), sheet.pointers(),
                   ExternalForces(sheet.masses, Vec3(0, -9.81, 0), {}), integrator, options);
  }
};

TEST(HingeStep, ChoosesHingesByStrengthAndOffersCoresWithoutThem) {
  for (const double k_bend : {1e-9, 1e-4}) {
    HingedRun run(k_bend);
    Stepper stepper = run.stepper("auto", IntegratorKind::semi_implicit_euler);
    stepper.begin(run.state, 5e-3);
    const LinearSystem system = stepper.system();
    const bool is_stiff = k_bend > 1e-6;
    const Index springs = run.sheet.models[0]->block_count(),
                hinges = run.sheet.models[1]->vector_count() / 4;
    EXPECT_EQ(stepper.core_springs("all"), springs + hinges);
    EXPECT_LE(system.core.rho, 8.0 * (1.0 + 1e-6));
    ASSERT_EQ(system.other_cores.size(), 2u);
    EXPECT_GT(system.stiffness, 0.0);
    if (!is_stiff) {
      // Weak ones are left out: the core is the paper's, and whole hinges are outside.
      EXPECT_EQ(stepper.core_springs(), springs);
      EXPECT_EQ(system.core.nodes_outside, 4);
      EXPECT_TRUE(system.core.matrix);
      EXPECT_TRUE(system.other_cores[0].mask.empty());
      continue;
    }
    EXPECT_EQ(stepper.core_springs(), springs + hinges);
    EXPECT_EQ(stepper.core_springs("stretch"), springs);
    EXPECT_EQ(system.core.rho, 0.0);
    EXPECT_FALSE(system.core.matrix);
    const Core& stretch = system.other_cores[0];
    EXPECT_EQ(stretch.name, "stretch");
    ASSERT_TRUE(stretch.matrix);
    EXPECT_GT(stretch.rho, 8.0);
    EXPECT_EQ(stretch.condition(), 1.0 + 4.0 * stretch.rho);
    // Without any shear springs there is no third one.
    EXPECT_TRUE(system.other_cores[1].mask.empty());
  }
}

// Between the two: some are left out, by what the nodes allow.
TEST(HingeStep, KeepsRhoBelowTheTarget) {
  bool some = false;
  for (const double k_bend : {2e-7, 5e-7, 1e-6, 2e-6, 5e-6}) {
    HingedRun run(k_bend);
    Stepper stepper = run.stepper("auto", IntegratorKind::semi_implicit_euler);
    stepper.begin(run.state, 5e-3);
    const LinearSystem system = stepper.system();
    EXPECT_LE(system.core.rho, 8.0 * (1.0 + 1e-6)) << k_bend;
    const Index springs = run.sheet.models[0]->block_count();
    some |= stepper.core_springs() > springs && system.core.matrix;
  }
  EXPECT_TRUE(some);
}

// Also where matrices are linearised again, and the first one's core is asked for once more: Newton
// and BDF2, contact's passes, another solver than the step's own.
TEST(HingeStep, AllSolversTakeTheSheetTheSameWay) {
  for (const IntegratorKind integrator :
       {IntegratorKind::semi_implicit_euler, IntegratorKind::bdf2, IntegratorKind::newton}) {
    std::vector<Vec3> expected;
    for (const char* solver :
         {"block_cholesky", "core_fast", "core_pcg:block", "auto", "upcg:ic0_core"}) {
      HingedRun run(2e-6);
      Stepper stepper = run.stepper(solver, integrator);
      for (int step = 0; step < 4; ++step) {
        stepper.begin(run.state, 5e-3);
        SolveSummary summary;
        for (int pass = 0; pass < 2; ++pass) {
          summary = stepper.solve(run.constraints, {});
          ASSERT_TRUE(summary.status.ok() || integrator == IntegratorKind::newton)
              << solver << ": " << summary.status.message;
          if (summary.bound_iterations >= 0) {
            EXPECT_LE(summary.iterations, summary.bound_iterations) << solver;
          }
        }
        EXPECT_EQ(stepper.remainder_ratio(), stepper.system().core.rho) << solver;
        stepper.commit(run.state);
      }
      if (expected.empty()) expected = run.state.x;
      for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_LT((run.state.x[i] - expected[i]).norm(), 1e-5) << solver << ", node " << i;
    }
  }
}

}  // namespace
}  // namespace taut::test
