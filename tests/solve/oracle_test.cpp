// Every solver there is against the dense KKT solution of small constrained systems.

#include <gtest/gtest.h>

#include "solve/constrained_case.h"

namespace taut::test {
namespace {

class Solver : public testing::TestWithParam<std::string> {
 protected:
  static SolverOptions options() { return solver_options(GetParam(), 1e-10); }
};

INSTANTIATE_TEST_SUITE_P(All, Solver, testing::ValuesIn(solvers_to_test()),
                         [](const auto& solver) { return test_name(solver.param); });

void expect_solved(const ConstrainedCase& c, ConstrainedSolver& solver) {
  const Eigen::VectorXd expected = c.solution();
  std::vector<double> x(c.b.size(), 1e300);
  const SolveSummary summary = solver.solve(c.system(), x);
  EXPECT_TRUE(summary.status.ok())
      << name_of(summary.status.outcome) << ": " << summary.status.message;
  EXPECT_LT(relative_difference(x, expected), 1e-7);

  // S A x = S b and (I-S) x = (I-S) z, with S from the normals.
  const Eigen::MatrixXd s = c.projection(), a = dense(c.a);
  const Eigen::VectorXd constrained = c.constraint_rows() * (as_eigen(x) - as_eigen(c.z));
  const Eigen::VectorXd residual = s * (as_eigen(c.b) - a * as_eigen(x));
  EXPECT_LT(residual.norm(), 1e-8 * as_eigen(c.b).norm());
  EXPECT_LT(constrained.norm(), 1e-8 * as_eigen(c.z).norm());

  // The summary tells the true residual, relative to the driving right-hand side.
  const Eigen::VectorXd prescribed = as_eigen(c.z) - s * as_eigen(c.z);
  const double driving = (s * (as_eigen(c.b) - a * prescribed)).norm();
  if (c.constraints.free_dofs() > 0) {
    EXPECT_NEAR(summary.relative_residual, residual.norm() / driving, 1e-13);
    EXPECT_NEAR(driving_norm(c.system()), driving, 1e-10 * driving);
  } else {
    EXPECT_EQ(summary.relative_residual, 0.0);
  }
}

TEST_P(Solver, AgainstKkt) {
  Random random(1);
  for (const FrameChoice frames : {FrameChoice::duff, FrameChoice::paper_eq13}) {
    // one for all systems: it must not remember the wrong things
    const auto solver = make_solver(options());
    for (const int only : {-1, -1, -1, 3, 2, 1, 0}) {
      SCOPED_TRACE("ndof " + std::to_string(only));
      expect_solved(random_case(random, {.nodes = 30, .frames = frames, .only = only}), *solver);
    }
  }
}

// The same pattern with new numbers, then with other constraints: the reused symbolic work must
// fit.
TEST_P(Solver, OneSolverForManySteps) {
  Random random(2);
  const auto solver = make_solver(options());
  ConstrainedCase c = random_case(random, {.nodes = 30});
  for (int step = 0; step < 3; ++step) {
    c.a.values = random_spd(random, c.a.pattern).values;
    c.b = random.vector(c.size());
    expect_solved(c, *solver);
  }
  for (Index i = 0; i < 30; ++i) {
    if (c.constraints.ndof(i) == 3 && i % 2 == 0) c.fix(i);
  }
  expect_solved(c, *solver);
}

TEST_P(Solver, IgnoresTheGuessInTheEnd) {
  Random random(3);
  ConstrainedCase c = random_case(random, {.nodes = 20});
  const auto solver = make_solver(options());
  c.guess.clear();
  expect_solved(c, *solver);
  const Eigen::VectorXd solution = c.solution();
  c.guess.assign(solution.begin(), solution.end());
  expect_solved(c, *solver);
  for (double& value : c.guess) value += 1e3;
  expect_solved(c, *solver);
}

// No constraints: a null pointer, and matrices of any dims.
TEST_P(Solver, WithoutConstraints) {
  Random random(4);
  for (const Index dim : {1, 3, 0}) {  // 0: mixed
    SCOPED_TRACE(dim);
    const auto graph = random_graph(random, 40, 3, 15);
    const BlockCsr a = random_spd(
        random, dim ? make_pattern(graph, dim) : make_pattern(graph, random_dims(random, 40)));
    const std::vector<double> b = random.vector(a.dofs());
    std::vector<double> x(b.size(), 1e300);
    LinearSystem system;
    system.matrix = &a, system.rhs = b;
    const SolveSummary summary = make_solver(options())->solve(system, x);
    EXPECT_TRUE(summary.status.ok()) << summary.status.message;
    EXPECT_LT(relative_difference(x, dense(a).llt().solve(as_eigen(b))), 1e-7);
  }
}

TEST_P(Solver, CoreIsOptional) {
  Random random(5);
  ConstrainedCase c = random_case(random, {.nodes = 20});
  c.core.clear();
  expect_solved(c, *make_solver(options()));
  c.core.assign(static_cast<std::size_t>(c.a.pattern->blocks()), 1);
  expect_solved(c, *make_solver(options()));
}

TEST(SolverNames, KnowsEachOther) {
  for (const std::string& name : solver_names()) {
    EXPECT_TRUE(is_solver_name(name));
    EXPECT_NE(make_solver(solver_options(name, 1e-3)), nullptr);
  }
  EXPECT_TRUE(is_solver_name("cholmod"));  // known whether it is built in or not
  EXPECT_FALSE(is_solver_name("jacobi"));
}

}  // namespace
}  // namespace taut::test
