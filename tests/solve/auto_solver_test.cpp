// The solver `auto`: right in every regime, settled on little counted work, the same choices from
// the same memory, and never stuck.

#include "taut/solve/auto_solver.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "solve/material_sheet.h"
#include "taut/base/error.h"
#include "taut/solve/reference.h"

namespace taut::test {
namespace {

// Right-hand sides of a slowly changing motion, each starting from the last solution.
struct Steps {
  MaterialSheet sheet;
  std::unique_ptr<ConstrainedSolver> solver;
  std::vector<double> x;
  std::vector<double> base;

  Steps(const Material& material, std::uint32_t seed, double tolerance = 1e-3)
      : sheet(material, seed),
        solver(make_solver(solver_options("auto", tolerance))),
        x(sheet.b.size()),
        base(sheet.b) {
    sheet.hold_some();
  }
  SolveSummary next(int step) {
    for (std::size_t i = 0; i < base.size(); ++i)
      sheet.b[i] = base[i] * (1.0 + 0.3 * std::sin(0.2 * step + 0.01 * static_cast<double>(i)));
    sheet.guess = x;
    return solver->solve(sheet.with_core(sheet.chosen), x);
  }
};

TEST(AutoSolver, SolvesEveryRegimeToTheAccuracyOfCorePcg) {
  std::uint32_t seed = 60;
  std::set<std::pair<std::string, std::string>> methods;
  for (const double h : {0.2e-3, 1e-3, 3.67e-3, 16.7e-3, 33e-3})
    for (const double k_shear : {0.3, 30.0, 600.0})
      for (const double k_stretch : {1.0, 6000.0, 6e6}) {
        Steps steps({.k_stretch = k_stretch,
                     .k_shear = k_shear,
                     .k_bend = k_shear / 10,
                     .h = h,
                     .graded = ++seed % 2 == 0},
                    seed);
        SCOPED_TRACE(steps.sheet.material.describe());
        for (int step = 0; step < 8; ++step) {
          const SolveSummary summary = steps.next(step);
          ASSERT_TRUE(summary.status.ok()) << summary.status.message;
          EXPECT_EQ(summary.solver, "auto");
          EXPECT_TRUE(is_solver_name(summary.method)) << summary.method;
          if (summary.method.starts_with("core")) {
            EXPECT_LE(summary.iterations, summary.bound_iterations);
          }
          EXPECT_EQ(summary.fallbacks, 0) << summary.remark;
          const LinearSystem system = steps.sheet.with_core(steps.sheet.chosen);
          EXPECT_LT(anorm_error(system, steps.x, reference_solution(system)), 1e-2)
              << summary.remark;
          methods.emplace(summary.method, summary.core);
        }
      }
  EXPECT_GE(methods.size(), 2u) << "one method for all";
}

TEST(AutoSolver, SoftClothNeedsNoFactorAndStiffClothDoes) {
  const auto settled = [](const Material& material) {
    Steps steps(material, 61);
    SolveSummary summary;
    for (int step = 0; step < 12; ++step) summary = steps.next(step);
    // Between the two block-diagonal methods, one of which is core_fast on an empty core, hardly
    // anything decides.
    constexpr double block_diagonal = 9.0;  // entries a node, at most
    const bool factorised =
        summary.factor_nonzeros > block_diagonal * static_cast<double>(steps.sheet.masses.size());
    return factorised ? summary.method : "no factor";
  };
  EXPECT_EQ(settled({.k_stretch = 1, .k_shear = 0.1, .k_bend = 0.05, .h = 1e-3, .nodes = 41}),
            "no factor");
  EXPECT_EQ(settled({.k_stretch = 6e6, .k_shear = 0.3, .k_bend = 0.05, .h = 16.7e-3, .nodes = 41}),
            auto_core_method);
}

// The last of twelve solves costs, by the counts, little more than the cheapest of the methods
// alone would.
TEST(AutoSolver, SettlesNearTheLeastCountedWork) {
  for (const double k_stretch : {6.0, 600.0, 6e4})
    for (const double h : {1e-3, 5e-3}) {
      Steps steps({.k_stretch = k_stretch, .h = h, .nodes = 31}, 62);
      SCOPED_TRACE(steps.sheet.material.describe());
      SolveSummary last;
      for (int step = 0; step < 12; ++step) last = steps.next(step);
      LinearSystem system = steps.sheet.with_core(steps.sheet.chosen);
      const SystemSize size = size_of(system);
      double least = 1e300, taken = 1e300;
      for (const std::string name : {auto_core_method, "upcg:projected_block_diagonal",
                                     "upcg:ic0_core", "upcg:ic0", "block_cholesky"}) {
        std::vector<double> x(steps.x.size());
        // The guess is last step's solution as in `auto`, no worse: what steps.x holds is this
        // step's.
        system.guess = steps.sheet.guess;
        const SolveSummary s = make_solver(solver_options(name, 1e-3))->solve(system, x);
        const FactorSize factor{s.factor_nonzeros, s.factor_flops, s.left_out_nonzeros};
        const MethodWork work =
            name == auto_core_method                  ? core_work(size, factor)
            : name == "upcg:projected_block_diagonal" ? block_diagonal_work(size)
            : name == "upcg:ic0_core" ? incomplete_work(size, size.core_nonzeros, s.preparations)
            : name == "upcg:ic0"      ? incomplete_work(size, size.nonzeros, s.preparations)
                                      : direct_work(factor);
        const double total = work.total(s.iterations);
        least = std::min(least, total);
        if (name == last.method) taken = work.total(last.iterations);
      }
      EXPECT_LE(taken, 1.7 * least) << last.method << ", " << last.iterations << " iterations";
    }
}

// Where stretch springs are so soft that the bound allows some of them to be left out, the paper's
// core takes fewer iterations.
TEST(AutoSolver, TakesThePapersCoreWhereItCostsLess) {
  MaterialSheet sheet({.k_stretch = 60, .h = 1e-3, .nodes = 41}, 64);
  sheet.hold_some();
  ASSERT_NE(sheet.chosen, sheet.stretch);
  LinearSystem system = sheet.with_core(sheet.chosen);
  system.other_cores = {{"stretch", sheet.stretch, sheet.rho(sheet.stretch)}};
  const auto solver = make_solver(solver_options("auto", 1e-6));
  std::vector<double> x(sheet.b.size());
  SolveSummary summary;
  for (int step = 0; step < 10; ++step) summary = solver->solve(system, x);
  ASSERT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_EQ(summary.core, "stretch") << summary.method;
  EXPECT_LE(summary.iterations, summary.bound_iterations);
  const SolveSummary chosen =
      make_solver(solver_options("core_fast", 1e-6))->solve(sheet.with_core(sheet.chosen), x);
  EXPECT_LT(summary.iterations, chosen.iterations);
  system.other_cores[0].mask = {};
  EXPECT_NE(solver->solve(system, x).core, "stretch");
}

// Where shear and bending are strong, all but bending in the core are enough, and the accuracy is
// proved.
TEST(AutoSolver, LeavesBendingOutWhereItCostsMost) {
  MaterialSheet sheet(
      {.k_stretch = 6000, .k_shear = 6000, .k_bend = 50, .h = 16.7e-3, .motion = 0.3, .nodes = 41},
      66);
  sheet.hold_some();
  ASSERT_EQ(std::ranges::count(sheet.chosen, 0), 0);
  LinearSystem system = sheet.with_core(sheet.chosen);
  system.other_cores = {{"stretch", sheet.stretch, sheet.rho(sheet.stretch)},
                        {"unbent", sheet.unbent, sheet.rho(sheet.unbent)}};
  const auto solver = make_solver(solver_options("auto", 1e-3));
  std::vector<double> x(sheet.b.size());
  SolveSummary summary;
  for (int step = 0; step < 10; ++step) summary = solver->solve(system, x);
  ASSERT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_EQ(summary.core, "unbent") << summary.method;
  EXPECT_LE(summary.iterations, summary.bound_iterations);
  const double error = anorm_error(system, x, reference_solution(system));
  EXPECT_LE(error, summary.error_bound + 1e-5);
  EXPECT_LE(summary.error_bound, 3.0 * std::sqrt(2.0) * 1e-3);
}

// Where every spring is strong, a core that leaves some out costs more than all of them: the direct
// solve, in single precision.
TEST(AutoSolver, TakesAllSpringsWhereAllAreStrong) {
  MaterialSheet sheet({.k_stretch = 60, .k_shear = 6e4, .k_bend = 6e3, .h = 3.67e-3, .nodes = 41},
                      65);
  sheet.hold_some();
  const LinearSystem system = sheet.with_core(sheet.stretch);
  const auto solver = make_solver(solver_options("auto", 1e-3));
  std::vector<double> x(sheet.b.size());
  SolveSummary summary;
  for (int step = 0; step < 10; ++step) summary = solver->solve(system, x);
  ASSERT_TRUE(summary.status.ok()) << summary.status.message;
  EXPECT_EQ(summary.core, "all") << summary.method;
  EXPECT_STREQ(summary.precision, "single");
  EXPECT_LE(summary.iterations, 2);
  EXPECT_LE(summary.iterations, summary.bound_iterations);
  EXPECT_LT(anorm_error(system, x, reference_solution(system)), 1e-3);
}

TEST(AutoSolver, TheSameMemoryMakesTheSameChoices) {
  for (const int until : {0, 1, 3, 9, 30}) {
    const Material material{.k_stretch = 300, .h = 3e-3, .nodes = 21};
    Steps first(material, 63), second(material, 63);
    for (int step = 0; step < until; ++step) first.next(step);
    second.x = first.x;
    second.solver->restore_memory(first.solver->memory());
    for (int step = until; step < until + 20; ++step) {
      const SolveSummary a = first.next(step), b = second.next(step);
      EXPECT_EQ(a.method, b.method);
      EXPECT_EQ(a.iterations, b.iterations);
      EXPECT_TRUE(first.x == second.x) << "step " << step << " after " << until;
    }
    EXPECT_EQ(first.solver->memory(), second.solver->memory());
  }
}

TEST(AutoSolver, RefusesAForeignMemory) {
  const auto solver = make_solver(solver_options("auto", 1e-3));
  EXPECT_THROW(solver->restore_memory(std::vector<double>{99.0, 1.0}), InputError);
  EXPECT_THROW(solver->restore_memory(std::vector<double>{1.0, 1.0, 2.0}), InputError);
  EXPECT_THROW(solver->restore_memory(std::vector<double>{7.0, 1.0, -2.0}), InputError);
  EXPECT_THROW(solver->restore_memory(std::vector<double>{7.0, 1.0, 1e300}), InputError);
  EXPECT_THROW(solver->restore_memory(std::vector<double>{7.0, 1.0, 2.0, 3.0}), InputError);
  EXPECT_THROW(make_solver(solver_options("mpcg", 1e-3))->restore_memory(solver->memory()),
               InputError);
  EXPECT_NO_THROW(make_solver(solver_options("mpcg", 1e-3))->restore_memory({}));
}

// Two grids and a node between them, bound to one of each: [1 1 1; 1 1 1; 1 1 1] + I/10, positive
// definite, but not without its corner, which the core leaves out and its factor has no place for.
TEST(AutoSolver, GoesDirectWhereTheCoreFailsAndRemembersIt) {
  constexpr Index side = 14, grid = side * side, hub = 2 * grid, first = 3 * side + 2,
                  second = grid + 5 * side + 3;
  std::vector<std::vector<Index>> links(2 * grid + 1);
  for (Index i = 0; i < 2 * grid; ++i) {
    if ((i + 1) % side != 0) links[i].push_back(i + 1), links[i + 1].push_back(i);
    if (i % grid + side < grid) links[i].push_back(i + side), links[i + side].push_back(i);
  }
  const std::array<Index, 3> bound{first, hub, second};
  for (const Index i : bound)
    for (const Index j : bound)
      if (i != j) links[i].push_back(j);
  BlockCsr a(make_pattern(links, 1));
  for_each_entry(a, [&](Index r, Index c, double& value) {
    const bool are_bound = std::ranges::count(bound, r) > 0 && std::ranges::count(bound, c) > 0;
    value = r == c ? 5.0 : are_bound ? 0.0 : -1.0;
    if (are_bound) value += r == c ? 110.0 : 100.0;
  });
  std::vector<std::uint8_t> core(static_cast<std::size_t>(a.pattern->blocks()), 1);
  core[a.pattern->find(first, second)] = core[a.pattern->find(second, first)] = 0;
  Random random(1);
  const std::vector<double> b = random.vector(a.dofs());
  LinearSystem system;
  system.matrix = &a, system.rhs = b, system.core.mask = core;
  const auto solver = make_solver(solver_options("auto", 1e-6));
  for (int step = 0; step < 5; ++step) {
    std::vector<double> x(b.size());
    const SolveSummary summary = solver->solve(system, x);
    ASSERT_TRUE(summary.status.ok()) << summary.status.message;
    EXPECT_EQ(summary.fallbacks > 0, step == 0) << summary.remark;
    EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), 1e-5);
    if (step == 0) {
      EXPECT_EQ(summary.method, "block_cholesky");
      EXPECT_NE(summary.remark.find(std::string(auto_core_method) + " failed"), std::string::npos)
          << summary.remark;
    }
  }
}

}  // namespace
}  // namespace taut::test
