// PARDISO's CG on the factor of an earlier system: when it is used, when it falls back, and that
// the answer is right either way. PARDISO also falls back when its clock tells it to, which it may
// at any time, so what is about CG is tried several times.

#include <gtest/gtest.h>

#include <limits>

#include "sheet.h"
#include "taut/base/parallel.h"
#include "taut/solve/solver.h"

namespace taut::test {
namespace {

constexpr int attempts = 20;

// A sheet with some nodes held, its solver, and systems that follow each other.
class Sequence {
 public:
  explicit Sequence(double tolerance = 1e-9) {
    SolverOptions options;
    options.name = "pardiso_cgs";
    options.tolerance = tolerance;
    solver_ = make_solver(options);
    constraints.reset(a.rows());
    for (Index i = 0; i < a.rows(); i += 100) constraints.fix(i, Vec3::Zero());
  }
  SolveSummary solve(double change = 0.0) {
    if (change > 0.0) stiffen(random_, a, change);
    LinearSystem system;
    system.matrix = &a, system.rhs = b_, system.constraints = &constraints, system.z = z_;
    return solver_->solve(system, x);
  }

 private:
  Random random_{1};

 public:
  BlockCsr a = sheet(random_, 24);
  ConstraintSet constraints;
  std::vector<double> x = std::vector<double>(static_cast<std::size_t>(a.dofs()));

 private:
  std::vector<double> b_ = random_.vector(a.dofs()), z_ = random_.vector(a.dofs());
  std::unique_ptr<ConstrainedSolver> solver_;
};

bool says(const SolveSummary& summary, const std::string& part) {
  return summary.remark.find(part) != std::string::npos;
}
bool fell_back(const SolveSummary& summary) { return says(summary, "gave up"); }

TEST(PardisoCgs, FactorisesFirst) {
  const SolveSummary first = Sequence().solve();
  EXPECT_TRUE(first.status.ok() && first.iterations == 0 && first.remark.empty()) << first.remark;
  EXPECT_GT(first.order_ms, 0.0);
  EXPECT_GT(first.factor_ms, 0.0);
  EXPECT_LT(first.relative_residual, 1e-12);
}

// Three systems, each further from the first; false when PARDISO's clock spoiled it.
bool iterates_more_for_larger_changes() {
  Sequence sequence;
  sequence.solve();
  int before = 0;
  for (const double change : {1e-6, 1e-2, 1e-1}) {
    const SolveSummary next = sequence.solve(change);
    EXPECT_TRUE(next.status.ok());
    EXPECT_LT(next.relative_residual, 1e-7);
    if (fell_back(next)) return false;
    EXPECT_EQ(next.factor_ms, 0.0);
    EXPECT_GT(next.iterations, before);
    EXPECT_TRUE(next.remark.empty()) << next.remark;
    before = next.iterations;
  }
  return true;
}

TEST(PardisoCgs, ThenIterates) {
  for (int attempt = 0; attempt < attempts; ++attempt)
    if (iterates_more_for_larger_changes()) return;
  FAIL() << "PARDISO fell back in each of " << attempts << " attempts";
}

TEST(PardisoCgs, FallsBackWhenTheMatrixChangedMuch) {
  Sequence sequence;
  sequence.solve();
  const SolveSummary far = sequence.solve(1e4);
  EXPECT_TRUE(far.status.ok() && says(far, "gave up (fall-back 1 in 2 systems)")) << far.remark;
  EXPECT_EQ(far.iterations, 0);
  EXPECT_GT(far.factor_ms, 0.0);
  EXPECT_LT(far.relative_residual, 1e-11);  // that of a factorisation
  EXPECT_TRUE(says(sequence.solve(1e4), "fall-back 2 in 3 systems"));
  // The new factor is kept: for the same matrix CG takes next to no iterations.
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const SolveSummary same = sequence.solve();
    ASSERT_TRUE(same.status.ok());
    if (fell_back(same)) continue;
    EXPECT_GT(same.iterations, 0);
    EXPECT_LE(same.iterations, 3);
    return;
  }
  FAIL() << "PARDISO factorised the same matrix " << attempts << " times";
}

TEST(PardisoCgs, OtherConstraintsNeedAnotherFactor) {
  Sequence sequence;
  sequence.solve();
  sequence.constraints.fix(1, Vec3::Zero());
  const SolveSummary other = sequence.solve();
  EXPECT_TRUE(other.status.ok() && other.iterations == 0 && says(other, "another pattern"))
      << other.remark;
  EXPECT_FALSE(fell_back(other));
  EXPECT_GT(other.order_ms, 0.0);
  EXPECT_LT(other.relative_residual, 1e-12);
}

TEST(PardisoCgs, ToleranceDecidesHowManyDigits) {
  int iterations_before = 0;
  double residual_before = 10.0;
  for (const double tolerance : {1e-1, 1e-3, 1e-6, 1e-9}) {
    SolveSummary summary;
    for (int attempt = 0; attempt < attempts && summary.iterations == 0; ++attempt) {
      Sequence sequence(tolerance);
      sequence.solve();
      summary = sequence.solve(0.3);
    }
    // PARDISO watches the clock: where its factorisation was quick, many iterations are refused,
    // whatever the attempt.
    if (summary.iterations == 0 && iterations_before > 5) break;
    ASSERT_GT(summary.iterations, iterations_before) << tolerance;
    EXPECT_LT(summary.relative_residual, 0.2 * residual_before);
    EXPECT_LT(summary.relative_residual, 30.0 * tolerance);
    iterations_before = summary.iterations, residual_before = summary.relative_residual;
  }
}

TEST(PardisoCgs, RefusesNaNAndIndefiniteThenRecovers) {
  Sequence sequence;
  sequence.solve();
  const BlockCsr good = sequence.a;
  sequence.a.block(30, good.pattern->diagonal[30])[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(sequence.solve().status.outcome, Outcome::not_positive_definite);
  for (const double factor : {1.0, -1.0, 1.0}) {
    sequence.a = good;
    for (double& value : sequence.a.values) value *= factor;
    const SolveSummary summary = sequence.solve();
    // Whether CG or the factorisation notices: -A must not pass for solved unless it is.
    if (factor > 0.0) {
      EXPECT_TRUE(summary.status.ok()) << summary.status.message;
    }
    if (summary.status.ok()) {
      EXPECT_LT(summary.relative_residual, 1e-7);
    }
  }
}

TEST(PardisoCgs, AnyNumberOfThreadsSolves) {
  const int before = thread_count();
  std::vector<std::vector<double>> firsts;
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    Sequence sequence(1e-6);
    sequence.solve();
    firsts.push_back(sequence.x);  // by a factorisation: the same bits
    EXPECT_LT(sequence.solve(0.1).relative_residual, 1e-4);
  }
  set_thread_count(before);
  EXPECT_EQ(firsts[0], firsts[1]);
}

}  // namespace
}  // namespace taut::test
