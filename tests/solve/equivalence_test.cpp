// What the methods have in common: MPCG takes uPCG's steps, the choice of U matters to a scalar
// diagonal only, and Eq. 10, the pre-filtered form and the direct solution are the same solution
// (docs/mathematics.md, 3).

#include <gtest/gtest.h>

#include "solve/constrained_case.h"

namespace taut::test {
namespace {

struct History {
  std::vector<Eigen::VectorXd> iterates;
  std::vector<double> values;
  SolveSummary summary;
  std::vector<double> x;
};

History solved(const ConstrainedCase& c, const SolverOptions& options) {
  History result;
  const auto solver = make_solver(options);
  solver->observer = [&](int, double value, std::span<const double> x) {
    result.iterates.push_back(as_eigen(x));
    result.values.push_back(value);
  };
  result.x.resize(c.b.size());
  result.summary = solver->solve(c.system(), result.x);
  EXPECT_TRUE(result.summary.status.ok()) << options.name << ": " << result.summary.status.message;
  EXPECT_EQ(result.summary.solver, options.name);
  EXPECT_EQ(static_cast<int>(result.iterates.size()), result.summary.iterations);
  return result;
}

History solved(const ConstrainedCase& c, const std::string& name, double tolerance) {
  return solved(c, solver_options(name, tolerance));
}

// Largest relative difference of iterates of the same number.
double largest_difference(const History& a, const History& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < std::min(a.iterates.size(), b.iterates.size()); ++k)
    largest = std::max(largest, (a.iterates[k] - b.iterates[k]).norm() / a.iterates[k].norm());
  return largest;
}

ConstrainedCase stiff_case(std::uint32_t seed, FrameChoice frames = FrameChoice::duff) {
  Random random(seed);
  return random_case(random, {.nodes = 60, .frames = frames, .margin = 1e-3});
}

TEST(MpcgAndUpcg, AgreeIterationByIteration) {
  for (const std::string variant : {"diagonal", "block_diagonal"})
    for (const FrameChoice frames : {FrameChoice::duff, FrameChoice::paper_eq13})
      for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        const ConstrainedCase c = stiff_case(seed, frames);
        const History mpcg = solved(c, "mpcg:" + variant, 1e-6),
                      upcg = solved(c, "upcg:" + variant, 1e-6);
        EXPECT_EQ(mpcg.summary.iterations, upcg.summary.iterations);
        EXPECT_GT(mpcg.summary.iterations, 8);
        EXPECT_LT(largest_difference(mpcg, upcg), 1e-9);
        EXPECT_NEAR(mpcg.summary.start_value, upcg.summary.start_value,
                    1e-10 * upcg.summary.start_value);
        for (std::size_t k = 0; k < std::min(mpcg.values.size(), upcg.values.size()); ++k)
          EXPECT_NEAR(mpcg.values[k], upcg.values[k], 1e-6 * upcg.values[k]);
      }
}

void expect_same_iterates(const ConstrainedCase& c, const std::string& one,
                          const std::string& other) {
  SCOPED_TRACE(one + ", " + other);
  const History a = solved(c, one, 1e-6), b = solved(c, other, 1e-6);
  EXPECT_EQ(a.summary.iterations, b.summary.iterations);
  EXPECT_GT(a.summary.iterations, 3);
  EXPECT_LT(largest_difference(a, b), 1e-9);
}

// The pre-filtered form with its own diagonal blocks is uPCG with the blocks of Ã, in the larger
// space; and so with every block-wise preconditioner of S A S + d (I-S), in MPCG too.
TEST(BlockwisePreconditioners, AreTheSameInEveryForm) {
  for (const FrameChoice frames : {FrameChoice::duff, FrameChoice::paper_eq13})
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
      const ConstrainedCase c = stiff_case(seed, frames);
      expect_same_iterates(c, "ppcg", "upcg:projected_block_diagonal");
      expect_same_iterates(c, "mpcg:projected_block_diagonal", "upcg:projected_block_diagonal");
      for (const std::string kind : {"ic0", "ic0_core", "ssor"})
        for (const std::string form : {"mpcg:", "ppcg:"})
          expect_same_iterates(c, form + kind, "upcg:" + kind);
    }
}

// Of the pattern's subsets, the core with all blocks is the matrix, with none its block diagonal.
TEST(IncompleteCholeskyOfTheCore, BetweenWholeAndBlockDiagonal) {
  ConstrainedCase c = stiff_case(5);
  EXPECT_GT(largest_difference(solved(c, "upcg:ic0_core", 1e-6), solved(c, "upcg:ic0", 1e-6)),
            1e-4);
  c.core.assign(c.core.size(), 1);
  expect_same_iterates(c, "upcg:ic0_core", "upcg:ic0");
  c.core.clear();
  expect_same_iterates(c, "upcg:ic0_core", "upcg:projected_block_diagonal");
}

// The test case's core is a chain: its incomplete factor is complete.
TEST(IncompleteCholeskyOfTheCore, OfAChainIsCorePcg) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed)
    expect_same_iterates(stiff_case(seed), "upcg:ic0_core", "core_pcg:eigen");
}

// Positive definite, but IC(0) breaks down on it: the shift is found, told, and the solution found
// with it.
TEST(IncompleteCholesky, TellsItsShift) {
  // Kershaw's matrix (1978) in each of three directions; one node held in one of them.
  ConstrainedCase c;
  c.a = BlockCsr(make_pattern({{1, 3}, {0, 2}, {1, 3}, {0, 2}}, 3));
  for_each_entry(c.a, [](Index row, Index column, double& value) {
    const Index i = row / 3, j = column / 3;
    if (row % 3 == column % 3) value = i == j ? 3.0 : std::abs(i - j) == 3 ? 2.0 : -2.0;
  });
  Random random(8);
  c.b = random.vector(12), c.z = random.vector(12);
  c.constraints.reset(4);
  c.constrain(1, random.direction());
  for (const std::string form : {"upcg:ic0", "mpcg:ic0", "ppcg:ic0"}) {
    const History found = solved(c, form, 1e-10);
    EXPECT_NE(found.summary.remark.find("raised by"), std::string::npos) << found.summary.remark;
    EXPECT_LT(relative_difference(found.x, c.solution()), 1e-7);
  }
}

TEST(Ssor, TakesItsFactorFromTheOptions) {
  const ConstrainedCase c = stiff_case(3);
  SolverOptions options = solver_options("upcg:ssor", 1e-6);
  const History plain = solved(c, options);
  options.ssor_omega = 1.5;
  const History relaxed = solved(c, options);
  EXPECT_GT(largest_difference(plain, relaxed), 1e-4);
  EXPECT_LT(relative_difference(relaxed.x, as_eigen(plain.x)), 1e-3);
}

Eigen::VectorXd reduced_eigenvalues(const ConstrainedCase& c) {
  const Eigen::MatrixXd u = c.dense_u();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(u.transpose() * dense(c.a) * u,
                                                        Eigen::EigenvaluesOnly)
      .eigenvalues();
}

TEST(ChoiceOfU, LeavesTheConditionNumberAlone) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const ConstrainedCase duff = stiff_case(seed), eq13 = stiff_case(seed, FrameChoice::paper_eq13);
    ASSERT_GT((duff.dense_u() - eq13.dense_u()).norm(), 1.0);
    const Eigen::VectorXd a = reduced_eigenvalues(duff), b = reduced_eigenvalues(eq13);
    EXPECT_LT((a - b).norm(), 1e-12 * a.norm());
  }
}

TEST(ChoiceOfU, IsSeenByTheReducedScalarDiagonalOnly) {
  const ConstrainedCase duff = stiff_case(1), eq13 = stiff_case(1, FrameChoice::paper_eq13);
  const auto difference = [&](const std::string& name) {
    return largest_difference(solved(duff, name, 1e-6), solved(eq13, name, 1e-6));
  };
  for (const std::string name :
       {"mpcg:diagonal", "mpcg:block_diagonal", "upcg:diagonal", "upcg:block_diagonal",
        "upcg:projected_block_diagonal", "ppcg", "upcg:ic0", "upcg:ic0_core", "upcg:ssor"})
    EXPECT_LT(difference(name), 1e-9) << name;
  EXPECT_GT(difference("upcg:reduced_diagonal"), 1e-5);
}

TEST(ChoiceOfU, DiagonalsDiffer) {
  // uPCG with Uᵀ diag(A)⁻¹ U and with diag(Ã)⁻¹ are two methods, though both are called diagonal.
  const ConstrainedCase c = stiff_case(2);
  EXPECT_GT(largest_difference(solved(c, "upcg:diagonal", 1e-6),
                               solved(c, "upcg:reduced_diagonal", 1e-6)),
            1e-5);
}

TEST(Eq10, IsEquivalentAfterAll) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const ConstrainedCase c = stiff_case(seed);
    const History direct = solved(c, "eigen_ldlt", 1e-12);
    for (const std::string name : {"eq10", "eq10:ilu0", "ppcg"})
      EXPECT_LT(relative_difference(solved(c, name, 1e-12).x, as_eigen(direct.x)), 1e-9) << name;
  }
}

// Eq. 10's scale d on I - S is a choice of units: kilograms a hundred times smaller must not cost
// iterations.
TEST(Eq10, DoesNotDependOnTheUnitOfMass) {
  ConstrainedCase c = stiff_case(3);
  const History kilograms = solved(c, "eq10", 1e-8);
  for (double& value : c.a.values) value *= 1e-6;
  for (double& value : c.b) value *= 1e-6;
  const History milligrams = solved(c, "eq10", 1e-8);
  EXPECT_LT(relative_difference(milligrams.x, as_eigen(kilograms.x)), 1e-6);
  EXPECT_LE(std::abs(milligrams.summary.iterations - kilograms.summary.iterations), 1);
}

TEST(CorePcg, BothReorderingsAreTheSameMethod) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed)
    for (const std::string& name : solver_names()) {
      if (!name.starts_with("core_pcg")) continue;
      const ConstrainedCase c = stiff_case(seed);
      SolverOptions options = solver_options(name, 1e-8);
      options.reordering = "vectors";
      const History vectors = solved(c, options);
      options.reordering = "matrix";
      const History matrix = solved(c, options);
      EXPECT_EQ(matrix.summary.iterations, vectors.summary.iterations);
      EXPECT_GT(matrix.summary.iterations, 3);
      EXPECT_LT(largest_difference(matrix, vectors), 1e-10);
      EXPECT_LT(relative_difference(matrix.x, as_eigen(vectors.x)), 1e-10);
    }
}

// P = A: one iteration. P = the block diagonal: uPCG with the blocks of Ã.
TEST(CorePcg, BetweenDirectAndBlockDiagonal) {
  ConstrainedCase c = stiff_case(5);
  c.core.assign(c.core.size(), 1);
  EXPECT_EQ(solved(c, "core_pcg", 1e-8).summary.iterations, 1);
  c.core.clear();
  const History blocks = solved(c, "core_pcg", 1e-6),
                upcg = solved(c, "upcg:projected_block_diagonal", 1e-6);
  EXPECT_EQ(blocks.summary.iterations, upcg.summary.iterations);
  EXPECT_LT(largest_difference(blocks, upcg), 1e-9);
}

// The paper's preconditioner is built from U: A_core is reduced like A.
TEST(CorePcg, IteratesAreThoseOfPcgWithTheReducedCore) {
  const ConstrainedCase c = stiff_case(6);
  const Eigen::MatrixXd u = c.dense_u(), a = dense(c.a);
  Eigen::MatrixXd core = a;
  const BlockPattern& p = *c.a.pattern;
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      if (!c.core[k]) core.block<3, 3>(3 * i, 3 * p.column[k]).setZero();
  const Eigen::LLT<Eigen::MatrixXd> factor(u.transpose() * core * u);
  ASSERT_EQ(factor.info(), Eigen::Success);
  const Eigen::VectorXd prescribed = as_eigen(c.z) - u * (u.transpose() * as_eigen(c.z));
  const Eigen::MatrixXd a_reduced = u.transpose() * a * u;
  const Eigen::VectorXd b = u.transpose() * (as_eigen(c.b) - a * prescribed);

  const History found = solved(c, "core_pcg", 1e-8);
  Eigen::VectorXd y = u.transpose() * as_eigen(c.guess);
  Eigen::VectorXd r = b - a_reduced * y, search = factor.solve(r);
  double delta = r.dot(search);
  const double delta0 = b.dot(factor.solve(b));
  EXPECT_NEAR(found.summary.start_value, std::sqrt(delta / delta0), 1e-8);
  std::size_t k = 0;
  for (; delta > 1e-16 * delta0; ++k) {
    const Eigen::VectorXd q = a_reduced * search;
    const double alpha = delta / search.dot(q), previous = delta;
    y += alpha * search;
    r -= alpha * q;
    const Eigen::VectorXd s = factor.solve(r);
    delta = r.dot(s);
    search = s + delta / previous * search;
    ASSERT_LT(k, found.iterates.size());
    EXPECT_LT((found.iterates[k] - (u * y + prescribed)).norm(), 1e-9 * found.iterates[k].norm());
  }
  EXPECT_EQ(k, found.iterates.size());
}

}  // namespace
}  // namespace taut::test
