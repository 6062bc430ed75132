// Which links enter the core: the rules on random graphs, and the promise, iterations within the
// bound, on sheets of any material.

#include "taut/core/core_choice.h"

#include <gtest/gtest.h>

#include "solve/constrained_case.h"
#include "solve/material_sheet.h"
#include "taut/core/core_bound.h"

namespace taut::test {
namespace {

struct Links {
  std::shared_ptr<const BlockPattern> pattern;
  std::vector<double> bounds, masses;

  Links(Random& random, Index nodes)
      : pattern(make_pattern(random_graph(random, nodes, 4, 12), 3)) {
    bounds.assign(static_cast<std::size_t>(pattern->blocks()), 0.0);
    for (Index i = 0; i < nodes; ++i)
      for (Index k = pattern->diagonal[i] + 1; k < pattern->row_start[i + 1]; ++k)
        bounds[k] = bounds[pattern->find(pattern->column[k], i)] =
            std::pow(10.0, random.uniform(-2.0, 2.0));
    for (Index i = 0; i < nodes; ++i) masses.push_back(std::pow(10.0, random.uniform(-1.0, 1.0)));
  }
  // Of the links left out at each node, relative to its mass.
  std::vector<double> load(std::span<const std::uint8_t> core) const {
    std::vector<double> sum(masses.size(), 0.0);
    for (Index i = 0; i < pattern->rows(); ++i)
      for (Index k = pattern->row_start[i]; k < pattern->row_start[i + 1]; ++k)
        if (!core[k]) sum[i] += bounds[k] / masses[i];
    return sum;
  }
};

TEST(CoreChoice, LeavesOutWhatTheTargetAllowsAndNoMore) {
  Random random(21);
  for (const double target : {0.0, 0.5, 8.0, 50.0, 1e9}) {
    const Links links(random, 150);
    const BlockPattern& p = *links.pattern;
    const std::vector<std::uint8_t> core = choose_core(p, links.bounds, links.masses, target);
    const std::vector<double> load = links.load(core);
    Index in = 0, out = 0;
    for (Index i = 0; i < p.rows(); ++i) {
      EXPECT_TRUE(core[p.diagonal[i]]);
      EXPECT_LE(load[i], target * (1.0 + 1e-12));
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
        const Index j = p.column[k];
        EXPECT_EQ(core[k], core[p.find(j, i)]);
        if (i >= j) continue;
        ++(core[k] ? in : out);
        // Nothing is in the core that could stay out.
        if (core[k]) {
          EXPECT_TRUE(load[i] + links.bounds[k] / links.masses[i] > target * (1.0 - 1e-12) ||
                      load[j] + links.bounds[k] / links.masses[j] > target * (1.0 - 1e-12));
        }
      }
    }
    EXPECT_EQ(in == 0, target == 1e9);
    EXPECT_EQ(out == 0, target == 0.0);
  }
}

// A chain 0-1-2-3 with links of 1, 5, 3 and masses of 1, but the last of 0.1: shares 1, 5, 30.
TEST(CoreChoice, WeakestRelativeToTheLighterNodeFirst) {
  const auto pattern = make_pattern({{1}, {0, 2}, {1, 3}, {2}}, 3);
  std::vector<double> bounds(static_cast<std::size_t>(pattern->blocks()), 0.0);
  const auto set = [&](Index i, Index j, double c) {
    bounds[pattern->find(i, j)] = bounds[pattern->find(j, i)] = c;
  };
  set(0, 1, 1.0), set(1, 2, 5.0), set(2, 3, 3.0);
  const std::vector<double> masses{1.0, 1.0, 1.0, 0.1};
  const auto in_core = [&](double target) {
    const auto core = choose_core(*pattern, bounds, masses, target);
    return std::vector<bool>{core[pattern->find(0, 1)] != 0, core[pattern->find(1, 2)] != 0,
                             core[pattern->find(2, 3)] != 0};
  };
  EXPECT_EQ(in_core(0.9), (std::vector<bool>{true, true, true}));
  EXPECT_EQ(in_core(5.9), (std::vector<bool>{false, true, true}));
  EXPECT_EQ(in_core(8.0), (std::vector<bool>{false, false, true}));
  EXPECT_EQ(in_core(29.0), (std::vector<bool>{false, false, true}));
  EXPECT_EQ(in_core(30.0), (std::vector<bool>{false, false, false}));
}

TEST(CoreChoice, InThePapersSettingItIsThePapersCore) {
  const MaterialSheet sheet({.h = 3.67e-3}, 31);
  EXPECT_EQ(sheet.chosen, sheet.stretch);
}

TEST(CoreChoice, StaysWhileTheClothMoves) {
  for (const std::uint32_t seed : {32u, 33u, 34u}) {
    const MaterialSheet a({.k_shear = 10, .h = 5e-3, .motion = 0.0}, seed),
        b({.k_shear = 10, .h = 5e-3, .motion = 1.0}, seed);
    EXPECT_NE(a.a.values, b.a.values);
    EXPECT_EQ(a.chosen, b.chosen);
  }
}

// The promise, over what a scene may hold. The bound is that of the measured ρ, which is below the
// target.
TEST(CoreChoice, IterationsNeverExceedTheBound) {
  std::uint32_t seed = 40;
  int most = 0, most_with_stretch = 0;
  for (const double h : {1e-3, 3.67e-3, 16.7e-3, 33e-3})
    for (const double k_shear : {0.3, 30.0, 600.0})
      for (const double k_bend : {0.05, 5.0, 50.0})
        for (const double k_stretch : {60.0, 6000.0, 6e6}) {
          const bool graded = ++seed % 2 == 0;
          MaterialSheet sheet({.k_stretch = k_stretch,
                               .k_shear = k_shear,
                               .k_bend = k_bend,
                               .h = h,
                               .graded = graded},
                              seed);
          SCOPED_TRACE(sheet.material.describe());
          sheet.hold_some();
          EXPECT_LE(sheet.rho(sheet.chosen), core_target_rho * (1.0 + 1e-6));
          for (const double tolerance : {1e-3, 1e-7}) {
            const SolveSummary summary = sheet.solve("core_pcg:block", sheet.chosen, tolerance);
            ASSERT_TRUE(summary.status.ok()) << summary.status.message;
            EXPECT_LE(summary.iterations, summary.bound_iterations);
            EXPECT_LE(summary.bound_iterations,
                      core_iteration_bound(core_target_rho * (1.0 + 1e-6), summary.start_value,
                                           tolerance));
            EXPECT_LT(summary.relative_residual, 100.0 * tolerance);
            if (tolerance != 1e-3) continue;
            const SolveSummary paper = sheet.solve("core_pcg:block", sheet.stretch, tolerance);
            EXPECT_LE(paper.iterations, paper.bound_iterations);
            most = std::max(most, summary.iterations),
            most_with_stretch = std::max(most_with_stretch, paper.iterations);
          }
        }
  EXPECT_LE(most, 25);
  EXPECT_GT(most_with_stretch, 30)
      << "the sweep has no cell that needs more than the stretch springs";
}

// Softer stretch springs than shear springs: the core is whatever is strong.
TEST(CoreChoice, KnowsNoClasses) {
  MaterialSheet sheet({.k_stretch = 0.1, .k_shear = 500, .k_bend = 0.05, .h = 3.67e-3}, 77);
  Index stretch_in = 0;
  for (std::size_t k = 0; k < sheet.chosen.size(); ++k)
    stretch_in += sheet.stretch[k] && sheet.chosen[k];
  EXPECT_EQ(stretch_in, sheet.a.rows()) << "only the diagonal";
  EXPECT_NE(sheet.chosen, sheet.stretch);
}

}  // namespace
}  // namespace taut::test
