#include "taut/linalg/bicgstab.h"

#include <gtest/gtest.h>

#include <limits>

#include "linalg/random_matrix.h"
#include "taut/linalg/pcg.h"

namespace taut::test {
namespace {

// Far from symmetric, its eigenvalues off the real axis but right of the imaginary one.
BlockCsr random_nonsymmetric(Random& random, Index nodes) {
  const auto dims = random_dims(random, nodes);
  BlockCsr a = random_matrix(random, make_pattern(random_graph(random, nodes, 3, 20), dims));
  for_each_entry(a, [&](Index row, Index column, double& value) {
    if (row == column) value = random.uniform(6.0, 12.0);
  });
  return a;
}

TEST(Bicgstab, SolvesNonsymmetricSystems) {
  Random random(1);
  for (int trial = 0; trial < 5; ++trial) {
    const BlockCsr a = random_nonsymmetric(random, 100);
    ASSERT_GT((dense(a) - dense(a).transpose()).norm(), 0.2 * dense(a).norm());
    const std::vector<double> b = random.vector(a.dofs());
    std::vector<double> x = random.vector(a.dofs());
    DiagonalPreconditioner m;
    ASSERT_TRUE(m.update(a).ok());
    int calls = 0;
    KrylovOptions options{1e-11, 1000, [&](int iteration, double, std::span<const double>) {
                            EXPECT_EQ(iteration, ++calls);
                          }};
    const KrylovResult result = bicgstab(BlockCsrOperator(a), m, b, x, options);
    EXPECT_TRUE(result.status.ok()) << result.status.message;
    EXPECT_EQ(calls, result.iterations);
    EXPECT_LE(result.stop_value, 1e-11);
    // What is reported is the true residual.
    EXPECT_NEAR(result.stop_value,
                (as_eigen(b) - dense(a) * as_eigen(x)).norm() / as_eigen(b).norm(), 1e-14);
    EXPECT_LT(relative_difference(x, dense(a).partialPivLu().solve(as_eigen(b))), 1e-9);
  }
}

TEST(Bicgstab, NoRightHandSideMeansNoSolution) {
  Random random(2);
  const BlockCsr a = random_nonsymmetric(random, 10);
  DiagonalPreconditioner m;
  ASSERT_TRUE(m.update(a).ok());
  const std::vector<double> b(static_cast<std::size_t>(a.dofs()), 0.0);
  std::vector<double> x = random.vector(a.dofs());
  EXPECT_TRUE(bicgstab(BlockCsrOperator(a), m, b, x, {}).status.ok());
  EXPECT_EQ(x, b);
}

TEST(Bicgstab, ReportsTheLimit) {
  Random random(3);
  const BlockCsr a = random_nonsymmetric(random, 100);
  DiagonalPreconditioner m;
  ASSERT_TRUE(m.update(a).ok());
  const std::vector<double> b = random.vector(a.dofs());
  std::vector<double> x(b.size(), 0.0);
  const KrylovResult result = bicgstab(BlockCsrOperator(a), m, b, x, {1e-12, 2, {}});
  EXPECT_EQ(result.status.outcome, Outcome::max_iterations);
  EXPECT_EQ(result.iterations, 2);
}

struct Identity : Preconditioner {
  Status update(const BlockCsr&) override { return {}; }
  void apply(std::span<const double> r, std::span<double> z) const override {
    std::copy(r.begin(), r.end(), z.begin());
  }
};

// For a skew matrix rᵀA r = 0 whatever r: the method cannot take a single step.
TEST(Bicgstab, ReportsBreakdown) {
  BlockCsr a(make_pattern({{0}}, 2));
  a.values = {0.0, 1.0, -1.0, 0.0};
  const std::vector<double> b = {1.0, 2.0};
  std::vector<double> x = {0.0, 0.0};
  const KrylovResult result = bicgstab(BlockCsrOperator(a), Identity{}, b, x, {1e-6, 1000, {}});
  EXPECT_EQ(result.status.outcome, Outcome::breakdown) << name_of(result.status.outcome);
  EXPECT_TRUE(std::isfinite(x[0]) && std::isfinite(x[1]));
}

TEST(Bicgstab, ReportsWhatIsNotFinite) {
  Random random(4);
  BlockCsr a = random_nonsymmetric(random, 20);
  const std::vector<double> b = random.vector(a.dofs());
  std::vector<double> x(b.size(), 0.0);
  a.values[10] = std::numeric_limits<double>::quiet_NaN();
  const KrylovResult result = bicgstab(BlockCsrOperator(a), Identity{}, b, x, {1e-6, 1000, {}});
  EXPECT_EQ(result.status.outcome, Outcome::not_finite) << name_of(result.status.outcome);
}

}  // namespace
}  // namespace taut::test
