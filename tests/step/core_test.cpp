// The core that a stepper hands to its solver: whichever is asked for, the same from step to step,
// with its ρ.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "taut/core/core_bound.h"
#include "taut/element/cloth_springs.h"
#include "taut/step/stepper.h"

namespace taut {
namespace {

struct Cloth {
  GridShape shape{.nu = 9, .nv = 8, .u = 0.2 * Vec3::UnitX(), .v = 0.175 * Vec3::UnitZ()};
  std::vector<std::unique_ptr<SpringModel>> springs;
  State state;
  std::vector<double> masses;
  ConstraintSet constraints;

  Cloth() {
    const std::vector<Vec3> rest = make_grid(shape).positions;
    SpringMaterial material{.k_stretch = 6000, .k_shear = 5, .k_bend = 0.05};
    material.compression = Compression::linear;
    springs = grid_springs(shape, rest, material, 0, "sheet");
    state.x = rest, state.v.assign(rest.size(), Vec3(0.1, 0.2, 0.3));
    for (std::size_t i = 0; i < rest.size(); ++i)
      state.x[i].y() += 0.01 * std::sin(static_cast<double>(i));
    masses.assign(rest.size(), 9.5e-6);
    constraints.reset(shape.node_count());
    constraints.fix(0, Vec3::Zero());
  }
  Stepper stepper(const std::string& solver, const std::string& core,
                  IntegratorKind integrator = IntegratorKind::semi_implicit_euler) {
    std::vector<const ForceModel*> models;
    for (const auto& model : springs) models.push_back(model.get());
    SolverOptions options;
    options.name = solver, options.core = core;
    return Stepper(shape.node_count(), models, ExternalForces(masses, Vec3(0, 0, -9.81), {}),
                   integrator, options);
  }
};

constexpr ForceClass stretch_only[] = {ForceClass::stretch};

std::vector<std::uint8_t> mask_of(const Stepper& stepper) {
  return {stepper.core_mask().begin(), stepper.core_mask().end()};
}

TEST(StepperCore, IsTheStretchSpringsOrChosen) {
  Cloth cloth;
  for (const auto& [solver, core, chosen] :
       {std::tuple{"core_pcg:block", "", false}, std::tuple{"core_pcg:block", "auto", true},
        std::tuple{"auto", "", true}, std::tuple{"auto", "stretch", false}}) {
    Stepper stepper = cloth.stepper(solver, core);
    stepper.begin(cloth.state, 5e-3);
    EXPECT_EQ(mask_of(stepper),
              chosen ? stepper.chosen_core(5e-3) : stepper.family_core(stretch_only))
        << solver << ", " << core;
    const Index stretch = cloth.springs[0]->block_count();
    if (chosen) {
      EXPECT_GT(stepper.core_springs(), stretch);
    } else {
      EXPECT_EQ(stepper.core_springs(), stretch);
    }
    EXPECT_EQ(stepper.system().core.rho,
              remainder_ratio(stepper.matrix(), stepper.core_mask(), cloth.masses));
  }
}

TEST(StepperCore, OffersOtherCoresWithTheirRho) {
  Cloth cloth;
  Stepper stepper = cloth.stepper("auto", "");
  for (const double h : {1e-3, 50e-3}) {
    stepper.begin(cloth.state, h);
    const LinearSystem system = stepper.system();
    const bool all_are_strong = h > 1e-2;
    // Where the paper's core leaves out little, it is the chosen one and there is no other.
    EXPECT_EQ(system.core.name, "auto");
    ASSERT_EQ(system.other_cores.size(), 2u);
    EXPECT_EQ(system.other_cores[0].name, "stretch");
    EXPECT_EQ(system.other_cores[1].name, "stretch+shear");
    for (const Core& core : system.other_cores) EXPECT_EQ(core.mask.empty(), !all_are_strong);
    if (!all_are_strong) continue;
    const Index stretch = cloth.springs[0]->block_count(), shear = cloth.springs[1]->block_count();
    EXPECT_EQ(stepper.core_springs("stretch"), stretch);
    EXPECT_EQ(stepper.core_springs("stretch+shear"), stretch + shear);
    EXPECT_EQ(stepper.core_springs("all"), stretch + shear + cloth.springs[2]->block_count());
    for (const Core& core : system.other_cores)
      EXPECT_EQ(core.rho, remainder_ratio(stepper.matrix(), core.mask, cloth.masses));
    EXPECT_LT(system.other_cores[1].rho, system.other_cores[0].rho);
  }
}

// |A_ii| <= (1 + σ) m_i in any state, and not far above it.
TEST(StepperCore, BoundsTheStiffness) {
  for (const IntegratorKind kind : {IntegratorKind::semi_implicit_euler, IntegratorKind::bdf2}) {
    Cloth cloth;
    Stepper stepper = cloth.stepper("core_fast", "", kind);
    stepper.begin(cloth.state, 5e-3);
    const BlockCsr& a = stepper.matrix();
    double largest = 0.0;
    for (Index i = 0; i < a.rows(); ++i) {
      Mat3 diagonal;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          diagonal(r, c) = a.block(i, a.pattern->diagonal[i])[r * a.pattern->width(i) + c];
      largest = std::max(largest, Eigen::SelfAdjointEigenSolver<Mat3>(diagonal).eigenvalues()[2] /
                                      cloth.masses[static_cast<std::size_t>(i)]);
    }
    EXPECT_LE(largest, 1.0 + stepper.system().stiffness);
    EXPECT_GT(largest, 0.2 * stepper.system().stiffness);
  }
}

TEST(StepperCore, StaysInShorterStepsAndWhateverTheClothDoes) {
  for (const IntegratorKind kind :
       {IntegratorKind::semi_implicit_euler, IntegratorKind::bdf2, IntegratorKind::newton}) {
    Cloth cloth;
    Stepper stepper = cloth.stepper("auto", "", kind);
    stepper.choose_core(5e-3);
    const std::vector<std::uint8_t> core = mask_of(stepper);
    EXPECT_NE(core, stepper.family_core(stretch_only));
    for (const double h : {5e-3, 5e-3, 2.5e-3, 5e-3}) {
      stepper.begin(cloth.state, h);
      const SolveSummary summary = stepper.solve(cloth.constraints, {});
      // Newton's loop may end at its limit on this crumpled cloth; its systems are what counts
      // here.
      ASSERT_TRUE(summary.status.ok() || kind == IntegratorKind::newton) << summary.status.message;
      EXPECT_LE(stepper.system().core.rho, 8.0 * (1.0 + 1e-6));
      EXPECT_EQ(mask_of(stepper), core);
      stepper.commit(cloth.state);
    }
    // A longer one needs more.
    stepper.begin(cloth.state, 20e-3);
    EXPECT_NE(mask_of(stepper), core);
    EXPECT_LE(stepper.system().core.rho, 8.0 * (1.0 + 1e-6));
  }
}

}  // namespace
}  // namespace taut
