// Cores that leave hinges out, whose opposite corners are no springs: the reported κ against dense
// eigenvalues, and the solvers on them.

#include <gtest/gtest.h>

#include "core/hinged_sheet.h"
#include "solve/constrained_case.h"
#include "taut/base/parallel.h"
#include "taut/constraint/reduction.h"
#include "taut/solve/core_spectrum.h"
#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/reference.h"

namespace taut::test {
namespace {

// The bending stiffness at which the block of a hinge's opposite corners is 0.1 of their masses.
constexpr double unit_of_bending = 5e-7;

struct HingeCase {
  HingedSheet sheet;
  ElementCore core;
  CoreRest rest;
  ConstrainedCase c;

  HingeCase(double k_bend, Index nodes, double crumple, std::uint32_t seed = 1)
      : sheet({.k_bend = k_bend * unit_of_bending, .nu = nodes, .nv = nodes}) {
    Random random(seed);
    std::vector<Vec3> x = sheet.rest.positions;
    for (Vec3& place : x) place += crumple * sheet.material.spacing * random.direction();
    sheet.assemble(x);
    core = sheet.stretch_core();
    rest = sheet.rest_of(core);
    c.a = sheet.a;
    for (Index i = 0; i < sheet.nodes(); ++i)
      for (int k = 0; k < 3; ++k) c.b.push_back(sheet.material.node_mass * random.uniform());
    c.z.assign(c.b.size(), 0.0), c.guess.assign(c.b.size(), 0.0);
    c.constraints.reset(sheet.nodes());
  }
  void hold_some() {
    c.fix(0);
    if (sheet.nodes() > 8) c.constrain(5, Vec3(1, 2, 3)), c.constrain(7, Vec3::UnitY());
  }
  LinearSystem system() const {
    LinearSystem s = c.system();
    s.core = view(core, rest);
    s.masses = sheet.masses;
    return s;
  }
  double true_condition(const Eigen::MatrixXd& p) const {
    const Eigen::MatrixXd u = c.dense_u();
    const auto [least, largest] = spectrum(u.transpose() * dense(c.a) * u, u.transpose() * p * u);
    return largest / least;
  }
};

// From soft to a thousand times as stiff, one hinge and a sheet of them, flat and crumpled: the
// bound holds, on a flat sheet it is at most four times what is true, and conjugate gradients stay
// within theirs.
TEST(HingeCore, ReportsABoundThatHolds) {
  for (const Index nodes : {2, 6})
    for (const double k_bend : {1.0, 10.0, 100.0, 1000.0})
      for (const double crumple : {0.0, 0.1})
        for (const bool held : {false, true}) {
          SCOPED_TRACE(testing::Message() << nodes << " nodes, k_bend " << k_bend << ", crumple "
                                          << crumple << ", held " << held);
          HingeCase of(k_bend, nodes, crumple);
          if (held) of.hold_some();
          const LinearSystem system = of.system();
          ASSERT_TRUE(system.core.matrix);
          EXPECT_EQ(system.core.nodes_outside, 4);
          const Eigen::MatrixXd without = dense(*system.core.matrix),
                                paper = with_diagonal(without, system.core.rest_diagonal);
          BlockCsr own;
          EXPECT_LT((dense(core_matrix(system, own)) - paper).norm(), 1e-14 * paper.norm());
          for (const auto& [solver, p] : {std::pair{"core_fast", without},
                                          {"core_pcg:block", paper},
                                          {"core_pcg:eigen", paper}}) {
            const double expected = of.true_condition(p);
            for (const double tolerance : {1e-3, 1e-8}) {
              std::vector<double> x(of.c.b.size());
              const SolveSummary s =
                  make_solver(solver_options(solver, tolerance))->solve(system, x);
              ASSERT_TRUE(s.status.ok()) << s.status.message;
              EXPECT_GE(s.condition, expected * (1.0 - 1e-9)) << solver;
              // Where the sheet is flat, only masses resist bending; else stretch springs do too.
              if (crumple == 0.0) {
                EXPECT_LE(s.condition, 4.0 * expected) << solver;
              }
              EXPECT_EQ(s.condition, system.core.condition());
              EXPECT_EQ(s.core, "stretch");
              EXPECT_GT(s.bound_iterations, 0);
              EXPECT_LE(s.iterations, s.bound_iterations) << solver;
              // In single precision, stretch springs resist across by their rounding.
              EXPECT_LE(s.fallbacks, 1) << s.remark;
              EXPECT_EQ(s.remark.find("no bound"), std::string::npos) << s.remark;
              const double error = anorm_error(system, x, reference_solution(system));
              EXPECT_LE(error, 2.0 * std::sqrt(expected) * tolerance + 1e-12) << solver;
              if (s.error_bound >= 0.0) {
                EXPECT_LE(error, 1.01 * s.error_bound + 1e-6) << solver;
              }
              EXPECT_EQ(s.error_bound >= 0.0, std::string(solver) == "core_fast");
            }
          }
          const CoreSpectrum measured = measure_core_spectrum(system, 1e-3);
          EXPECT_NEAR(measured.largest / measured.smallest, of.true_condition(paper),
                      1e-3 * of.true_condition(paper));
          EXPECT_LE(measured.iterations, measured.bound_iterations);
          EXPECT_EQ(measured.bound, system.core.condition());
        }
}

// What would happen were hinges taken for springs: blocks deleted from A are not positive definite.
TEST(HingeCore, DeletedBlocksWouldNotBePositiveDefinite) {
  const HingeCase of(1000.0, 2, 0.0);
  Reduction deleted;
  deleted.update(of.c.a, nullptr, of.core.mask());
  EXPECT_NE(Eigen::LLT<Eigen::MatrixXd>(dense(deleted.matrix())).info(), Eigen::Success);
  for (const double k_bend : {10.0, 1000.0}) {
    const HingeCase soft(k_bend, 2, 0.0);
    EXPECT_FALSE(may_be_springs(soft.c.a, soft.core.mask()));
  }
}

// Whatever is made of the core stands on the same matrix.
TEST(HingeCore, EveryMethodGivesTheSameAnswer) {
  HingeCase of(300.0, 6, 0.1);
  of.hold_some();
  const LinearSystem system = of.system();
  const std::vector<double> exact = reference_solution(system);
  for (const char* solver : {"core_fast", "core_pcg:block", "upcg:ic0_core", "mpcg:ic0_core",
                             "ppcg:ic0_core", "auto", "block_cholesky"}) {
    std::vector<double> x(of.c.b.size());
    const SolveSummary s = make_solver(solver_options(solver, 1e-10))->solve(system, x);
    ASSERT_TRUE(s.status.ok()) << solver << ": " << s.status.message;
    EXPECT_LT(anorm_error(system, x, exact), 1e-7) << solver;
  }
}

// One object for cores with and without a matrix of their own.
TEST(HingeCore, GoesFromOneKindOfCoreToTheOther) {
  HingeCase of(300.0, 6, 0.1);
  const std::vector<std::uint8_t> all(of.core.mask().size(), 1);
  const auto solver = make_solver(solver_options("core_fast", 1e-8));
  LinearSystem system = of.system(), whole = system;
  whole.core = {"all", all, 0.0};
  // The same mask, but nothing known of what is outside: no bound, and it says so.
  LinearSystem unknown = system;
  unknown.core = {"unknown", of.core.mask()};
  const std::vector<double> exact = reference_solution(system);
  std::vector<double> x(of.c.b.size());
  for (int round = 0; round < 2; ++round) {
    SolveSummary s = solver->solve(system, x);
    ASSERT_TRUE(s.status.ok()) << s.status.message;
    EXPECT_GT(s.condition, 100.0);
    EXPECT_LT(anorm_error(system, x, exact), 1e-6);
    s = solver->solve(whole, x);
    ASSERT_TRUE(s.status.ok()) << s.status.message;
    EXPECT_EQ(s.condition, 2.0);
    EXPECT_LT(anorm_error(system, x, exact), 1e-6);
    s = solver->solve(unknown, x);
    EXPECT_LT(s.condition, 0.0);
    EXPECT_EQ(s.bound_iterations, -1);
    EXPECT_LT(s.error_bound, 0.0);
    if (s.status.ok()) {
      EXPECT_NE(s.remark.find("no bound"), std::string::npos) << s.remark;
      EXPECT_LT(anorm_error(system, x, exact), 1e-6);
    } else {
      EXPECT_EQ(s.status.outcome, Outcome::not_positive_definite);
    }
  }
}

TEST(HingeCore, SameBitsForAnyNumberOfThreads) {
  const int usual = thread_count();
  std::vector<double> first;
  for (const int threads : {1, 2, 3, 4}) {
    set_thread_count(threads);
    const HingeCase of(300.0, 40, 0.1);
    std::vector<double> x(of.c.b.size());
    ASSERT_TRUE(make_solver(solver_options("core_fast", 1e-6))->solve(of.system(), x).status.ok());
    if (threads == 1) first = x;
    EXPECT_EQ(x, first) << threads << " threads";
  }
  set_thread_count(usual);
}

// Blocks outside the core that a spring could have made are not, since it leaves a core that is
// not positive definite: then no bound is claimed either.
TEST(HingeCore, ARefutedBoundIsWithdrawn) {
  HingeCase of(1000.0, 2, 0.0);
  LinearSystem system = of.system();
  system.core.matrix = nullptr, system.core.rest_diagonal = {}, system.core.nodes_outside = 2;
  std::vector<std::uint8_t> mask(of.core.mask());
  const BlockPattern& p = *of.c.a.pattern;
  const BendingHinge& h = static_cast<const QuadraticBending&>(*of.sheet.models[1]).hinges()[0];
  // Of the hinge's springs all are left out, and the blocks of the other sign stay.
  for (const Index side : {0, 1})
    for (const Index corner : {2, 3}) {
      const Index i = h.node[static_cast<std::size_t>(side)],
                  j = h.node[static_cast<std::size_t>(corner)];
      mask[p.find(i, j)] = mask[p.find(j, i)] = 0;
    }
  mask[p.find(h.node[2], h.node[3])] = mask[p.find(h.node[3], h.node[2])] = 1;
  system.core.mask = mask;
  ASSERT_TRUE(may_be_springs(of.c.a, mask));
  std::vector<double> x(of.c.b.size());
  const SolveSummary s = make_solver(solver_options("core_fast", 1e-8))->solve(system, x);
  EXPECT_LT(s.condition, 0.0);
  EXPECT_EQ(s.bound_iterations, -1);
  EXPECT_LT(s.error_bound, 0.0);
}

}  // namespace
}  // namespace taut::test
