// The bound of docs/mathematics.md, 5 on real cloth matrices: λmax(P⁻¹A) <= 2, λmin(P⁻¹A) >=
// 1/(1+ρ), and with it the number of corePCG's iterations, measured by dense eigenvalues, over
// stiffnesses, time steps and constraints.

#include "taut/core/core_bound.h"

#include <gtest/gtest.h>

#include <limits>

#include "linalg/spring_grid.h"
#include "solve/constrained_case.h"
#include "taut/base/parallel.h"
#include "taut/constraint/reduction.h"
#include "taut/element/assembler.h"
#include "taut/element/cloth_springs.h"
#include "taut/solve/core_spectrum.h"

namespace taut::test {
namespace {

constexpr double node_mass = 9.5e-6;

struct Setting {
  double k_stretch, k_shear, k_bend, h, k_damp = 0.0;
  std::string describe() const {
    return "k_stretch " + std::to_string(k_stretch) + ", k_shear " + std::to_string(k_shear) +
           ", k_bend " + std::to_string(k_bend) + ", h " + std::to_string(h) + ", k_damp " +
           std::to_string(k_damp);
  }
};

const Setting settings[] = {{60, 0.3, 0.05, 6.67e-3},       {6000, 0.3, 0.05, 3.67e-3},
                            {6e6, 0.3, 0.05, 3.67e-3},      {6000, 30, 0.05, 3.67e-3},
                            {6000, 300, 5.0, 16.7e-3},      {600, 0.0, 0.5, 5.55e-3},
                            {600, 0.3, 0.05, 5.55e-3, 1e-3}};

// A sheet of 7 x 6 nodes, crumpled so that springs point anywhere, some stretched, some slack; its
// matrix, and what the core leaves out.
struct Sheet {
  ConstrainedCase c;
  Eigen::MatrixXd a, p;  // A and P = M + L_C + D_R
  double rho = 0.0;      // as the assembler says
  double rho_dense = 0.0;

  Sheet(const Setting& setting, Random& random) {
    GridShape shape;
    shape.nu = 7, shape.nv = 6;
    shape.u = 0.15 * Vec3::UnitX(), shape.v = 0.125 * Vec3::UnitZ();
    const std::vector<Vec3> rest = make_grid(shape).positions;
    std::vector<Vec3> x = rest, v(rest.size());
    for (Vec3& position : x) position = 1.05 * position + 0.005 * random.direction();
    for (Vec3& velocity : v) velocity = random.direction();
    SpringMaterial material;
    material.k_stretch = setting.k_stretch, material.k_shear = setting.k_shear,
    material.k_bend = setting.k_bend;
    material.k_damp_stretch = material.k_damp_shear = material.k_damp_bend = setting.k_damp;
    const auto models = grid_springs(shape, rest, material, 0, "sheet");
    std::vector<const ForceModel*> all;
    for (const auto& model : models) all.push_back(model.get());
    Assembler assembler(shape.node_count(), all, std::vector<bool>(all.size(), true));

    const std::vector<double> masses(rest.size(), node_mass);
    std::vector<Vec3> b(rest.size());
    const auto assemble = [&](bool remainder_too) {
      std::vector<ForceRequest> requests;
      for (const ForceModel* model : all) {
        ForceRequest request;
        request.x = x, request.v = v;
        const bool wanted = remainder_too || model->force_class() == ForceClass::stretch;
        request.matrix_stiffness = wanted ? setting.h * setting.h : 0.0;
        request.matrix_damping = wanted ? setting.h : 0.0;
        request.force = setting.h;
        requests.push_back(request);
      }
      assembler.assemble(requests, {masses, 1.0, {}, 0.0}, c.a, b);
      return dense(c.a);
    };
    c.a = BlockCsr(assembler.pattern());
    const Eigen::MatrixXd stretch_only = assemble(false);
    a = assemble(true);
    c.core = assembler.core_mask(ForceClass::stretch);
    rho = remainder_ratio(c.a, c.core, masses);

    p = stretch_only;
    for (Index i = 0; i < shape.node_count(); ++i) {
      const Mat3 remainder = (a - stretch_only).block<3, 3>(3 * i, 3 * i);
      p.block<3, 3>(3 * i, 3 * i) += remainder;
      rho_dense = std::max(
          rho_dense, Eigen::SelfAdjointEigenSolver<Mat3>(remainder).eigenvalues()[2] / node_mass);
    }
    const Index n = 3 * shape.node_count();
    c.b = random.vector(n), c.z = random.vector(n), c.guess = random.vector(n);
    // A right-hand side of the size of the guess's residual, as in a simulation that goes on
    // smoothly.
    for (double& value : c.b) value *= 10.0 * node_mass;
    c.constraints.reset(shape.node_count());
  }

  void constrain(Random& random) {
    const Index nodes = c.constraints.nodes();
    for (Index i = 0; i < nodes; ++i) {
      const Index kind = random.below(6);
      if (kind == 0) c.fix(i);
      if (kind == 1 || kind == 2) c.constrain(i, random.direction());
      if (kind == 2) c.constrain(i, Vec3(0.3, 0.5, 0.7));
    }
  }
};

TEST(CoreBound, RhoIsTheRemaindersShareOfTheMass) {
  Random random(1);
  for (const Setting& setting : settings) {
    const Sheet sheet(setting, random);
    EXPECT_NEAR(sheet.rho, sheet.rho_dense, 1e-6 * sheet.rho_dense) << setting.describe();
    EXPECT_GE(sheet.rho, sheet.rho_dense * (1.0 - 1e-12)) << setting.describe();
  }
}

// A bend spring over a stretch edge (two nodes joined by both) keeps its block: it belongs to the
// core.
TEST(CoreBound, SpringWhoseBlockSurvivesIsNotInTheRemainder) {
  const std::vector<Vec3> x{Vec3::Zero(), Vec3(1.2, 0, 0), Vec3(0, 1.3, 0)}, v(3, Vec3::Zero());
  const SpringModel stretch(ForceClass::stretch, SpringLawKind::linear,
                            {{0, 1, {.rest_length = 1.0, .stiffness = 10.0}}});
  const SpringModel bend(ForceClass::bend, SpringLawKind::linear,
                         {{0, 1, {.rest_length = 1.0, .stiffness = 7.0}},
                          {0, 2, {.rest_length = 1.0, .stiffness = 2.0}}});
  Assembler assembler(3, {&stretch, &bend}, {true, true});
  BlockCsr a(assembler.pattern());
  std::vector<Vec3> b(3);
  ForceRequest request;
  request.x = x, request.v = v, request.matrix_stiffness = 1.0;
  const std::vector<double> masses(3, 0.5);
  assembler.assemble(std::vector{request, request}, {masses, 1.0, {}, 0.0}, a, b);
  EXPECT_NEAR(remainder_ratio(a, assembler.core_mask(ForceClass::stretch), masses), 2.0 / 0.5,
              1e-5);
}

// Of thousands of rows, several cores at once: the largest eigenvalue of all, and the same bits for
// any number of threads.
TEST(CoreBound, FindsTheLargestRowOfMany) {
  Random random(10);
  const SpringGrid grid(random, 60, 50);
  const BlockPattern& p = *grid.a.pattern;
  std::vector<double> masses;
  for (Index i = 0; i < p.rows(); ++i) masses.push_back(random.uniform(0.5, 2.0));
  std::vector<std::uint8_t> all(grid.sides.size(), 1), none(grid.sides.size(), 0);
  const std::vector<std::span<const std::uint8_t>> cores{grid.sides, all, none};
  std::vector<double> expected;
  for (const auto& core : cores) {
    double largest = 0.0;
    for (Index i = 0; i < p.rows(); ++i) {
      Mat3 sum = Mat3::Zero();
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
        for (Index r = 0; r < 3 && !core[k] && p.column[k] != i; ++r)
          for (Index c = 0; c < 3; ++c) sum(r, c) -= grid.a.block(i, k)[r * p.width(i) + c];
      largest =
          std::max(largest, Eigen::SelfAdjointEigenSolver<Mat3>(sum).eigenvalues()[2] / masses[i]);
    }
    expected.push_back(largest);
  }
  const int usual = thread_count();
  std::vector<double> first;
  for (const int threads : {1, 2, 3, 4}) {
    set_thread_count(threads);
    const std::vector<double> ratios = remainder_ratios(grid.a, cores, masses);
    if (first.empty()) first = ratios;
    EXPECT_EQ(ratios, first) << threads << " threads";
    for (std::size_t c = 0; c < cores.size(); ++c)
      EXPECT_EQ(remainder_ratio(grid.a, cores[c], masses), ratios[c]);
  }
  set_thread_count(usual);
  for (std::size_t c = 0; c < cores.size(); ++c) {
    EXPECT_GE(first[c], expected[c]);
    EXPECT_LE(first[c], expected[c] * (1.0 + 1e-6));
  }
}

TEST(CoreBound, IterationsStayACount) {
  EXPECT_EQ(iteration_bound(std::numeric_limits<double>::infinity(), 1.0, 1e-3), 1'000'000'000);
  EXPECT_EQ(iteration_bound(4.0, 1.0, 1e-3), 9);  // ceil(ln 4000)
  EXPECT_EQ(iteration_bound(4.0, 1e-4, 1e-3), 0);
}

TEST(CoreBound, NothingLeftOutIsZero) {
  Random random(6);
  const Sheet sheet(settings[0], random);
  const std::vector<double> masses(static_cast<std::size_t>(sheet.c.a.rows()), node_mass);
  EXPECT_EQ(remainder_ratio(sheet.c.a, std::vector<std::uint8_t>(sheet.c.core.size(), 1), masses),
            0.0);
}

// A block outside the core that no spring makes: nothing is claimed, so that core_fast does not
// take springs out that are none.
TEST(CoreBound, IsNotKnownForBlocksThatAreNotSymmetric) {
  Random random(9);
  BlockCsr a = random_spd(random, make_pattern(random_graph(random, 20, 1, 5), 3));
  const std::vector<double> masses(20, 1.0);
  std::vector<std::uint8_t> core(static_cast<std::size_t>(a.pattern->blocks()), 1);
  EXPECT_EQ(remainder_ratio(a, core, masses), 0.0);
  core[a.pattern->find(4, 5)] = core[a.pattern->find(5, 4)] = 0;
  EXPECT_EQ(remainder_ratio(a, core, masses), -1.0);
  for (const auto& [i, j] : {std::pair{4, 5}, std::pair{5, 4}})
    for (Index r = 0; r < 3; ++r)
      for (Index c = 0; c < 3; ++c)
        a.block(i, a.pattern->find(i, j))[r * a.pattern->width(i) + c] = r == c ? -0.5 : 0.1;
  EXPECT_GT(remainder_ratio(a, core, masses), 0.0);
}

TEST(CoreBound, PreconditionerIsTheMatrixWithBlocksDeleted) {
  Random random(2);
  for (const Setting& setting : settings) {
    const Sheet sheet(setting, random);
    Reduction core;
    core.update(sheet.c.a, nullptr, sheet.c.core);
    EXPECT_LT((dense(core.matrix()) - sheet.p).norm(), 1e-12 * sheet.p.norm())
        << setting.describe();
  }
}

TEST(CoreBound, HoldsForTheEigenvalues) {
  Random random(3);
  for (const Setting& setting : settings)
    for (const bool constrained : {false, true}) {
      SCOPED_TRACE(setting.describe() + (constrained ? ", constrained" : ""));
      Sheet sheet(setting, random);
      if (constrained) sheet.constrain(random);
      const Eigen::MatrixXd u = sheet.c.dense_u();
      const Eigen::VectorXd lambda = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(
                                         u.transpose() * sheet.a * u, u.transpose() * sheet.p * u,
                                         Eigen::EigenvaluesOnly | Eigen::Ax_lBx)
                                         .eigenvalues();
      const double rounding = 1e-9;
      EXPECT_LE(lambda.maxCoeff(), 2.0 + rounding);
      EXPECT_GE(lambda.minCoeff(), 1.0 / (1.0 + sheet.rho) - rounding);
      LinearSystem system = sheet.c.system();
      system.core.rho = sheet.rho;
      const CoreSpectrum measured = measure_core_spectrum(system, 1e-3);
      EXPECT_NEAR(measured.smallest, lambda.minCoeff(), 1e-4 * lambda.minCoeff());
      EXPECT_NEAR(measured.largest, lambda.maxCoeff(), 1e-4 * lambda.maxCoeff());
      EXPECT_DOUBLE_EQ(measured.bound, 2.0 * (1.0 + sheet.rho));
      EXPECT_LE(measured.iterations, measured.bound_iterations);
      EXPECT_GT(measured.iterations, 0);
      // The remainder is really there: P is not A.
      if (!constrained) {
        EXPECT_GT(lambda.maxCoeff(), 1.0 + 0.01 * std::min(1.0, sheet.rho));
      }
    }
}

TEST(CoreBound, HoldsForTheIterations) {
  Random random(4);
  for (const Setting& setting : settings)
    for (const bool constrained : {false, true})
      for (const double tolerance : {1e-3, 1e-6}) {
        SCOPED_TRACE(setting.describe() + (constrained ? ", constrained" : ""));
        Sheet sheet(setting, random);
        if (constrained) sheet.constrain(random);
        std::vector<double> x(sheet.c.b.size());
        LinearSystem system = sheet.c.system();
        system.core.rho = sheet.rho;
        const SolveSummary summary =
            make_solver(solver_options("core_pcg", tolerance))->solve(system, x);
        ASSERT_TRUE(summary.status.ok()) << summary.status.message;
        const int bound = core_iteration_bound(sheet.rho, summary.start_value, tolerance);
        EXPECT_EQ(summary.bound_iterations, bound);
        EXPECT_LE(summary.iterations, bound);
        EXPECT_GT(summary.iterations, 0);
        // For a small remainder the bound is not only true but of use.
        if (sheet.rho < 5.0 && !constrained) {
          EXPECT_LE(bound, 8 * summary.iterations);
        }
      }
}

// The paper's observation: the count does not know the stretch stiffness.
TEST(CoreBound, IterationsDoNotGrowWithTheStretchStiffness) {
  std::vector<int> iterations;
  for (const double k_stretch : {60.0, 6e3, 6e5, 6e7}) {
    Random random(5);
    const Sheet sheet({k_stretch, 0.3, 0.05, 3.67e-3}, random);
    std::vector<double> x(sheet.c.b.size());
    iterations.push_back(
        make_solver(solver_options("core_pcg", 1e-3))->solve(sheet.c.system(), x).iterations);
  }
  for (const int count : iterations) {
    EXPECT_GE(count, 2);
    EXPECT_LE(count, 8);
  }
}

TEST(CoreBound, Formula) {
  EXPECT_EQ(core_iteration_bound(3.0, 0.5e-3, 1e-3), 0);  // the guess is good enough already
  EXPECT_EQ(core_iteration_bound(3.0, 1e-3, 1e-3), 0);
  // κ = 8: ceil(½ √8 ln(2 √8 / 1e-3)) = ceil(1.41421 * 8.64048) = ceil(12.2195)
  EXPECT_EQ(core_iteration_bound(3.0, 1.0, 1e-3), 13);
  // ρ = 0: κ = 2, ceil(0.70711 * ln(2.82843e6) = 14.8552) = ceil(10.504)
  EXPECT_EQ(core_iteration_bound(0.0, 1.0, 1e-6), 11);
  EXPECT_EQ(core_iteration_bound(3.0, 10.0, 1e-2), core_iteration_bound(3.0, 1.0, 1e-3));
}

}  // namespace
}  // namespace taut::test
