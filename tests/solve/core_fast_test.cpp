// core_fast takes core_pcg's steps, whatever the constraints; it goes to double precision by
// itself, and says so.

#include <gtest/gtest.h>

#include "linalg/spring_grid.h"
#include "solve/constrained_case.h"
#include "solve/material_sheet.h"
#include "taut/core/block_remainder.h"
#include "taut/core/core_bound.h"
#include "taut/linalg/block_cholesky.h"
#include "taut/solve/reference.h"

namespace taut::test {
namespace {

// The blocks that core_fast makes its core of: those asked for and those that have a place in their
// factor.
std::vector<std::uint8_t> core_with_fill(const ConstrainedCase& c) {
  BlockCholesky factor(CholeskyPrecision::single_precision);
  EXPECT_TRUE(factor.analyze(c.a.pattern, c.core, BlocksLeftOut::without_place).ok());
  return {factor.analyzed_blocks().begin(), factor.analyzed_blocks().end()};
}

TEST(CoreFast, TakesTheStepsOfCorePcg) {
  Random random(1);
  int larger = 0, smaller_than_all = 0;
  for (int trial = 0; trial < 10; ++trial) {
    CaseOptions options;
    options.nodes = 60;
    ConstrainedCase c = random_case(random, options);
    std::vector<double> x(c.b.size()), expected(c.b.size());
    LinearSystem same = c.system();
    const std::vector<std::uint8_t> core = core_with_fill(c);
    same.core.mask = core;
    larger += std::ranges::count(core, 1) > std::ranges::count(c.core, 1);
    smaller_than_all += std::ranges::count(core, 0) > 0;
    LinearSystem system = c.system();
    for (const bool from_rest : {true, false}) {
      // Last step's x is not looked at; an iterate is where it goes on.
      same.guess = from_rest ? std::span<const double>() : system.guess;
      system.guess_is_iterate = !from_rest;
      const SolveSummary slow =
          make_solver(solver_options("core_pcg:eigen", 1e-4))->solve(same, expected);
      const SolveSummary fast = make_solver(solver_options("core_fast", 1e-4))->solve(system, x);
      ASSERT_TRUE(fast.status.ok()) << fast.status.message;
      EXPECT_EQ(fast.iterations, slow.iterations);
      EXPECT_NEAR(fast.start_value, slow.start_value, 1e-5 * slow.start_value);
      EXPECT_NEAR(fast.stop_value, slow.stop_value, 1e-2 * slow.stop_value);
      EXPECT_LT(relative_difference(x, as_eigen(expected)), 1e-5);
      EXPECT_STREQ(fast.precision, "single");
      EXPECT_EQ(fast.fallbacks, 0);
    }
  }
  EXPECT_GT(larger, 5);
  EXPECT_GT(smaller_than_all, 5);
}

// A motion that is affine over the sheet: as smooth as can be.
std::vector<double> affine_motion(const MaterialSheet& sheet) {
  std::vector<double> x;
  for (Index i = 0; i < sheet.a.rows(); ++i) {
    const double u = i % sheet.material.nodes, v = i / sheet.material.nodes;
    x.insert(x.end(), {0.3 * u - 0.2 * v + 1.0, 0.4 * v, 0.1 * u + 0.5 * v});
  }
  return x;
}

// Where ρ is known the springs outside the core are taken out of it altogether, or parallelograms
// stand in for them: the same conjugate gradients as on a dense matrix made so; its eigenvalues
// within their bounds.
class CoreFastSteps : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Replaced, CoreFastSteps, testing::Bool());
TEST_P(CoreFastSteps, AreThoseOfTheSpringsInTheCore) {
  std::uint32_t seed = 20;
  double smallest = 1.0;
  for (const double k_stretch : {60.0, 6e3, 6e5})
    for (const double k_shear : {0.3, 30.0, 600.0}) {
      MaterialSheet sheet({.k_stretch = k_stretch,
                           .k_shear = k_shear,
                           .k_bend = k_shear / 10,
                           .h = 10e-3,
                           .nodes = 9},
                          ++seed);
      sheet.hold_some();
      SCOPED_TRACE(sheet.material.describe());
      sheet.core = sheet.stretch;
      LinearSystem system = sheet.with_core(sheet.stretch);
      const std::vector<double> smooth = affine_motion(sheet);
      system.masses = sheet.masses;
      if (GetParam()) system.last = smooth;
      const Eigen::MatrixXd all = dense(sheet.a);
      // Known, so that products from the factor are trusted as far as rounding allows: the same
      // directions, to its size.
      for (Index i = 0; i < sheet.a.rows(); ++i) {
        const Mat3 block = all.block<3, 3>(3 * i, 3 * i);
        system.stiffness = std::max(
            system.stiffness, block.operatorNorm() / sheet.masses[static_cast<std::size_t>(i)]);
      }
      const double rounding = 4.0 * 0x1p-24 * std::sqrt(1.0 + system.stiffness);
      BlockCholesky same_core(CholeskyPrecision::single_precision);
      ASSERT_TRUE(
          same_core.analyze(sheet.a.pattern, sheet.stretch, BlocksLeftOut::without_place).ok());
      const auto parallelograms = same_core.parallelograms();
      ASSERT_FALSE(parallelograms.empty());
      const Eigen::MatrixXd p =
          dense_core(sheet.a, same_core.analyzed_blocks(),
                     GetParam() ? parallelograms : std::span<const Parallelogram>());
      const Eigen::MatrixXd u = sheet.dense_u(), a = u.transpose() * dense(sheet.a) * u;
      const Eigen::LLT<Eigen::MatrixXd> factor(u.transpose() * p * u);
      ASSERT_EQ(factor.info(), Eigen::Success);
      Eigen::VectorXd r = u.transpose() * (as_eigen(sheet.b) - dense(sheet.a) * as_eigen(sheet.z)),
                      c = Eigen::VectorXd::Zero(r.size());
      const double delta0 = r.dot(factor.solve(r));
      double delta = delta0, last = 0.0;
      std::vector<double> stops;
      while (stops.size() < 8 && (stops.empty() || stops.back() > 1e-5)) {
        c = factor.solve(r) + (last > 0.0 ? delta / last : 0.0) * c;
        r -= delta / c.dot(a * c) * (a * c);
        last = delta, delta = r.dot(factor.solve(r));
        stops.push_back(std::sqrt(delta / delta0));
      }
      const auto solver = make_solver(solver_options("core_fast", 0.5 * stops.back()));
      std::vector<double> seen, x(sheet.b.size());
      solver->observer = [&](int, double stop, std::span<const double>) { seen.push_back(stop); };
      const SolveSummary summary = solver->solve(system, x);
      ASSERT_TRUE(summary.status.ok()) << summary.status.message;
      ASSERT_GE(seen.size(), stops.size());
      for (std::size_t k = 0; k < stops.size(); ++k)
        EXPECT_NEAR(seen[k], stops[k], 0.05 * stops[k] + 1e-6 + rounding) << k;

      EXPECT_EQ(summary.replaced, GetParam());
      BlockRemainder remainder;
      remainder.analyze(sheet.a.pattern, same_core.analyzed_blocks(), parallelograms);
      remainder.set_replaced(GetParam());
      remainder.update(sheet.a);
      const BlockRemainder::Ratios ratios = remainder.ratios(sheet.masses);
      const Eigen::VectorXd eigenvalues =
          Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(a, u.transpose() * p * u)
              .eigenvalues();
      EXPECT_GE(eigenvalues.minCoeff() * (1.0 + 4.0 * ratios.replaced), 1.0 - 1e-6);
      EXPECT_LE(eigenvalues.maxCoeff(), 1.0 + 2.0 * ratios.dropped + 1e-6);
      EXPECT_LE(summary.iterations, summary.bound_iterations);
      smallest = std::min(smallest, eigenvalues.minCoeff());
    }
  EXPECT_EQ(smallest < 0.5, GetParam()) << smallest;
}

// Parallelograms are better for what is smooth: it goes by last step's x. Without it, or the masses
// that the bound is made with, never.
TEST(CoreFast, ReplacesSpringsWhereMotionIsSmooth) {
  MaterialSheet sheet({.k_stretch = 60.0, .k_shear = 30.0, .motion = 0.0}, 5);
  sheet.hold_some();
  const std::vector<double> smooth = affine_motion(sheet);
  Random random(6);
  const std::vector<double> rough = random.vector(sheet.a.dofs());
  std::vector<double> x(sheet.b.size());
  LinearSystem system = sheet.with_core(sheet.stretch);
  // What it is to find is smooth.
  multiply(sheet.a, smooth, sheet.b);
  const auto solver = make_solver(solver_options("core_fast", 1e-6));
  const auto solve = [&](std::span<const double> last, std::span<const double> masses) {
    system.last = last, system.masses = masses;
    const SolveSummary summary = solver->solve(system, x);
    EXPECT_TRUE(summary.status.ok()) << summary.status.message;
    EXPECT_LE(anorm_error(system, x, reference_solution(system)), 1.01 * summary.error_bound);
    EXPECT_LE(summary.iterations, summary.bound_iterations);
    return summary;
  };
  const SolveSummary dropped = solve({}, sheet.masses);
  EXPECT_FALSE(dropped.replaced);
  const SolveSummary replaced = solve(smooth, sheet.masses);
  EXPECT_TRUE(replaced.replaced);
  EXPECT_LT(replaced.iterations, dropped.iterations);
  EXPECT_FALSE(solve(rough, sheet.masses).replaced);
  EXPECT_FALSE(solve(smooth, {}).replaced);
  EXPECT_TRUE(solve(smooth, sheet.masses).replaced);
}

TEST(CoreFast, ProvesItsError) {
  std::uint32_t seed = 40;
  for (const double h : {1e-3, 10e-3, 33e-3})
    for (const double k_stretch : {60.0, 6e3, 6e6})
      for (const double k_shear : {0.3, 600.0}) {
        MaterialSheet sheet({.k_stretch = k_stretch,
                             .k_shear = k_shear,
                             .k_bend = k_shear / 10,
                             .h = h,
                             .graded = seed % 2 == 0},
                            ++seed);
        sheet.hold_some();
        SCOPED_TRACE(sheet.material.describe());
        const std::vector<std::uint8_t>& core = seed % 3 == 0 ? sheet.unbent : sheet.stretch;
        std::vector<double> x(sheet.b.size());
        const std::vector<double> smooth = affine_motion(sheet);
        LinearSystem system = sheet.with_core(core);
        system.masses = sheet.masses;
        const auto solver = make_solver(solver_options("core_fast", 1e-3));
        for (const bool replaced : {false, true}) {
          if (replaced) system.last = smooth;
          const SolveSummary summary = solver->solve(system, x);
          ASSERT_TRUE(summary.status.ok()) << summary.status.message;
          EXPECT_EQ(summary.replaced, replaced && &core == &sheet.stretch);
          EXPECT_LE(anorm_error(system, x, reference_solution(system)),
                    summary.error_bound * 1.01 + 1e-5);
          if (!summary.replaced) {
            EXPECT_LE(summary.error_bound,
                      std::sqrt(1.0 + 2.0 * system.core.rho) * 1.01 * summary.stop_value + 1e-5);
          }
          EXPECT_LE(summary.iterations, summary.bound_iterations);
        }
      }
}

// What is no matrix of springs may lose its definiteness when blocks are lumped.
TEST(CoreFast, LumpsNothingWhereThatFails) {
  Random random(9);
  ConstrainedCase c = random_case(random, {.only = 3});
  const BlockPattern& p = *c.a.pattern;
  Index most = 0;  // blocks of a row
  for (Index i = 0; i < p.rows(); ++i) most = std::max(most, p.row_start[i + 1] - p.row_start[i]);
  // The diagonal is less than what is left out of the longest row.
  for_each_entry(c.a, [&](Index row, Index column, double& value) {
    value = row == column                                    ? 0.999 * (most - 1)
            : row / 3 != column / 3 && row % 3 == column % 3 ? -1.0
                                                             : 0.0;
  });
  c.core.assign(static_cast<std::size_t>(p.blocks()), 0);
  LinearSystem system = c.system();
  const Eigen::VectorXd expected = c.solution();
  ASSERT_EQ(Eigen::LLT<Eigen::MatrixXd>(dense(c.a)).info(), Eigen::Success);
  system.core.rho = 1.0;
  std::vector<double> x(c.b.size());
  const SolveSummary summary = make_solver(solver_options("core_fast", 1e-8))->solve(system, x);
  ASSERT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_EQ(summary.fallbacks, 2) << summary.remark;
  EXPECT_NE(summary.remark.find("not lumped"), std::string::npos);
  EXPECT_LT(summary.error_bound, 0.0);
  EXPECT_LT(relative_difference(x, expected), 1e-6);
}

// Single precision loses digits to the stiffness; the true residual, looked at on the way, brings
// them back.
TEST(CoreFast, IsAsExactAsAskedForAtAnyStiffness) {
  const auto expect_exact = [](Material material, double tolerance, bool stiffness_is_known) {
    MaterialSheet sheet(material, 7);
    sheet.hold_some();
    Random random(8);
    sheet.b = random.vector(sheet.size());
    LinearSystem system = sheet.with_core(sheet.stretch);
    if (stiffness_is_known) system.stiffness = 0.5 * block_diagonal_condition(*system.matrix) - 1.0;
    std::vector<double> x(sheet.b.size());
    const SolveSummary summary =
        make_solver(solver_options("core_fast", tolerance))->solve(system, x);
    ASSERT_TRUE(summary.status.ok()) << summary.status.message;
    // The stop test's norm and A's differ by the root of the condition that the core leaves, at
    // most; and nothing is more exact than the same method in double precision throughout.
    const std::vector<double> exact = reference_solution(system);
    double bound = std::sqrt(2.0 * (1.0 + system.core.rho)) * tolerance;
    const double error = anorm_error(system, x, exact);
    if (error >= bound) {
      ASSERT_TRUE(
          make_solver(solver_options("core_pcg:block", tolerance))->solve(system, x).status.ok());
      bound = std::max(bound, 2.0 * anorm_error(system, x, exact));
    }
    EXPECT_LT(error, bound) << material.describe() << (material.askew ? ", flat and askew" : "")
                            << ", tolerance " << tolerance;
    EXPECT_LE(summary.iterations, summary.bound_iterations);
  };
  for (const double k_stretch : {60.0, 6e3, 6e5, 6e7})
    for (const double tolerance : {1e-3, 1e-6, 1e-10})
      for (const bool stiffness_is_known : {true, false}) {
        expect_exact({.k_stretch = k_stretch, .nodes = 31}, tolerance, stiffness_is_known);
        // At rest: nothing but the masses and soft springs resists across, where rounded stretch
        // springs do.
        expect_exact(
            {.k_stretch = k_stretch, .motion = 0.0, .stretch = 1.0, .askew = true, .nodes = 31},
            tolerance, stiffness_is_known);
      }
}

// One object, one matrix pattern, contacts that come and go.
TEST(CoreFast, KeepsItsAnalysisWhileConstraintsChange) {
  Random random(2);
  for (const std::string name : {"core_fast", "block_cholesky"}) {
    const auto solver = make_solver(solver_options(name, 1e-10));
    ConstrainedCase first = random_case(random, {});
    for (int trial = 0; trial < 8; ++trial) {
      ConstrainedCase c = random_case(random, {});
      c.a = BlockCsr(first.a.pattern);
      c.a.values = random_spd(random, first.a.pattern).values;
      c.core.clear();
      for (Index i = 0; i < c.a.rows(); ++i)
        for (Index k = c.a.pattern->row_start[i]; k < c.a.pattern->row_start[i + 1]; ++k)
          c.core.push_back(std::abs(c.a.pattern->column[k] - i) <= 1);
      std::vector<double> x(c.b.size());
      const SolveSummary summary = solver->solve(c.system(), x);
      ASSERT_TRUE(summary.status.ok()) << summary.status.message;
      EXPECT_LT(relative_difference(x, c.solution()), 1e-8) << name;
    }
  }
}

TEST(CoreFast, FallsBackToDoubleWhenSingleOverflows) {
  Random random(3);
  ConstrainedCase c = random_case(random, {});
  const Eigen::VectorXd expected = c.solution();
  for (const std::span<double> values : {std::span<double>(c.a.values), std::span<double>(c.b)})
    for (double& value : values) value *= 1e100;
  std::vector<double> x(c.b.size());
  const SolveSummary summary = make_solver(solver_options("core_fast", 1e-8))->solve(c.system(), x);
  ASSERT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_STREQ(summary.precision, "double");
  EXPECT_EQ(summary.fallbacks, 1);
  EXPECT_FALSE(summary.remark.empty());
  EXPECT_LT(relative_difference(x, expected), 1e-6);
}

// Many stiff chains whose rigid motions only the masses hold: rounded to single precision the core
// loses these masses, so that a pivot fails or each chain's rigid motion gets an energy of its own,
// by chance.
TEST(CoreFast, FallsBackToDoubleWhereSinglePrecisionLosesTheMasses) {
  Random random(4);
  constexpr Index nodes = 400, length = 5;
  ConstrainedCase c;
  std::vector<std::vector<Index>> links(nodes);
  for (Index i = 0; i + 1 < nodes; ++i)
    if (i % length != length - 1) links[i].push_back(i + 1), links[i + 1].push_back(i);
  c.a = BlockCsr(make_pattern(links, 3));
  for_each_entry(c.a, [&](Index row, Index column, double& value) {
    const Index i = row / 3;
    const double stiffness = 1e9 * (1.0 + 0.37 * (i / length));
    if (row == column)
      value = 1.0 + stiffness * (i % length == 0 || i % length == length - 1 ? 1.0 : 2.0);
    if (row != column && row % 3 == column % 3) value = -stiffness;
  });
  c.b = random.vector(3 * nodes), c.z.assign(c.b.size(), 0.0);
  c.constraints.reset(nodes);
  c.core.assign(static_cast<std::size_t>(c.a.pattern->blocks()), 1);
  std::vector<double> x(c.b.size());
  const SolveSummary summary = make_solver(solver_options("core_fast", 1e-6))->solve(c.system(), x);
  ASSERT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_LT(summary.stop_value, 1e-6);
  EXPECT_EQ(summary.fallbacks, 1);
  EXPECT_STREQ(summary.precision, "double");
  EXPECT_LT(summary.iterations, 30);
}

// Where the stiffness says that single precision would lose the masses, it is not tried.
TEST(CoreFast, BeginsInDoubleWhereSinglePrecisionWouldFail) {
  for (const double k_stretch : {6e3, 6e8}) {
    MaterialSheet sheet({.k_stretch = k_stretch}, 12);
    sheet.hold_some();
    LinearSystem system = sheet.with_core(sheet.stretch);
    system.stiffness = 0.5 * block_diagonal_condition(*system.matrix) - 1.0;
    std::vector<double> x(sheet.b.size());
    const SolveSummary summary = make_solver(solver_options("core_fast", 1e-6))->solve(system, x);
    ASSERT_TRUE(summary.status.ok()) << summary.status.message;
    EXPECT_STREQ(summary.precision, k_stretch > 1e6 ? "double" : "single");
    EXPECT_EQ(summary.fallbacks, 0) << summary.remark;
    EXPECT_LE(summary.iterations, summary.bound_iterations);
    EXPECT_LE(anorm_error(system, x, reference_solution(system)),
              summary.error_bound * 1.01 + 1e-9);
  }
}

TEST(CoreFast, NothingToDo) {
  Random random(5);
  ConstrainedCase c = random_case(random, {.only = 0});
  std::vector<double> x(c.b.size());
  const SolveSummary summary = make_solver(solver_options("core_fast", 1e-6))->solve(c.system(), x);
  EXPECT_TRUE(summary.status.ok());
  EXPECT_EQ(summary.iterations, 0);
  EXPECT_EQ(x, c.z);
}

TEST(CoreFast, AnIndefiniteMatrixIsReported) {
  Random random(6);
  ConstrainedCase c = random_case(random, {.only = 3});
  for (double& value : c.a.values) value = -value;
  std::vector<double> x(c.b.size());
  const SolveSummary summary = make_solver(solver_options("core_fast", 1e-6))->solve(c.system(), x);
  EXPECT_EQ(summary.status.outcome, Outcome::not_positive_definite);
  EXPECT_EQ(summary.fallbacks, 1);
}

}  // namespace
}  // namespace taut::test
