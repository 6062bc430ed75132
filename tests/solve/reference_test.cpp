#include "taut/solve/reference.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "taut/solve/solver.h"

namespace taut {
namespace {

// The square of the second difference: integers, and a condition number that grows as n⁴.
BlockCsr biharmonic(Index n) {
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i)
    for (Index j = std::max(0, i - 2); j <= std::min(n - 1, i + 2); ++j) columns[i].push_back(j);
  BlockCsr a(make_pattern(columns, 1));
  const double by_distance[] = {6.0, -4.0, 1.0};
  for (Index i = 0; i < n; ++i)
    for (Index k = a.pattern->row_start[i]; k < a.pattern->row_start[i + 1]; ++k) {
      const Index j = a.pattern->column[k];
      *a.block(i, k) = i == j && (i == 0 || i == n - 1) ? 5.0 : by_distance[std::abs(i - j)];
    }
  return a;
}

TEST(Reference, IsExactWhereASingleSolveIsNot) {
  const Index n = 3000;
  const BlockCsr a = biharmonic(n);
  std::vector<double> x(static_cast<std::size_t>(n)), b(x.size());
  // smooth, where A is nearly singular
  for (Index i = 0; i < n; ++i) x[i] = double(i + 1) * (n - i) + i % 2;
  multiply(a, x, b);  // sums of integers: exact
  LinearSystem system;
  system.matrix = &a;
  system.rhs = b;
  ReferenceReport report;
  const std::vector<double> reference = reference_solution(system, report);
  ASSERT_TRUE(report.status.ok()) << report.status.message;
  std::vector<double> direct(x.size());
  ASSERT_TRUE(make_solver({.name = "eigen_ldlt"})->solve(system, direct).status.ok());

  EXPECT_GT(anorm_error(system, direct, x), 1e-9);
  EXPECT_LT(anorm_error(system, reference, x), 1e-14);
  EXPECT_GE(report.refinements, 1);
  EXPECT_LT(report.error_estimate, 1e-14);
}

struct ConstrainedCase {
  BlockCsr a;
  Eigen::MatrixXd dense;
  ConstraintSet constraints;
  std::vector<double> b, z;
  LinearSystem system() const {
    LinearSystem s;
    s.matrix = &a, s.rhs = b, s.constraints = &constraints, s.z = z;
    return s;
  }
};

// Five nodes, all coupled, with ndof 3, 2, 1, 0, 2.
ConstrainedCase random_case(unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  constexpr Index n = 5;
  ConstrainedCase c;
  const Eigen::MatrixXd root =
      Eigen::MatrixXd::NullaryExpr(3 * n, 3 * n, [&] { return normal(generator); });
  c.dense = root * root.transpose() + Eigen::MatrixXd::Identity(3 * n, 3 * n);
  c.a = BlockCsr(make_pattern(std::vector<std::vector<Index>>(n, {0, 1, 2, 3, 4}), 3));
  for (Index i = 0; i < n; ++i)
    for (Index r = 0; r < 3; ++r)
      for (Index j = 0; j < 3 * n; ++j)
        c.a.block(i, c.a.pattern->row_start[i])[r * 3 * n + j] = c.dense(3 * i + r, j);
  c.constraints.reset(n);
  const auto direction = [&] {
    return Vec3(normal(generator), normal(generator), normal(generator));
  };
  c.constraints.constrain(1, direction(), 0.1);
  c.constraints.constrain(2, direction(), 0.2);
  c.constraints.constrain(2, direction(), 0.3);
  c.constraints.fix(3, direction());
  c.constraints.constrain(4, direction(), -0.4);
  for (Index i = 0; i < n; ++i)
    for (int r = 0; r < 3; ++r)
      c.z.push_back(c.constraints.displacement(i)[r]), c.b.push_back(normal(generator));
  return c;
}

Eigen::MatrixXd projection(const ConstraintSet& constraints) {
  Eigen::MatrixXd s = Eigen::MatrixXd::Zero(3 * constraints.nodes(), 3 * constraints.nodes());
  for (Index i = 0; i < constraints.nodes(); ++i)
    s.block<3, 3>(3 * i, 3 * i) = constraints.projection(i);
  return s;
}

TEST(Reference, SolvesTheConstrainedSystem) {
  const ConstrainedCase c = random_case(3);
  const std::vector<double> x = reference_solution(c.system());
  const Eigen::MatrixXd s = projection(c.constraints), id = Eigen::MatrixXd::Identity(15, 15);
  const Eigen::Map<const Eigen::VectorXd> b(c.b.data(), 15), z(c.z.data(), 15), found(x.data(), 15);
  // the paper's Eq. 10
  const Eigen::VectorXd expected = (s * c.dense + id - s).fullPivLu().solve(s * b + (id - s) * z);
  EXPECT_LT((found - expected).norm(), 1e-12 * expected.norm());
}

TEST(Reference, ErrorIsMeasuredInTheFreeDirectionsOnly) {
  const ConstrainedCase c = random_case(4);
  const std::vector<double> reference = reference_solution(c.system());
  const Eigen::MatrixXd s = projection(c.constraints);
  const Eigen::Map<const Eigen::VectorXd> star(reference.data(), 15);
  Eigen::VectorXd x = star + Eigen::VectorXd::LinSpaced(15, -0.3, 0.7);
  const Eigen::VectorXd e = s * (x - star), y = s * star;
  const double expected = std::sqrt(e.dot(c.dense * e) / y.dot(c.dense * y));
  EXPECT_NEAR(anorm_error(c.system(), std::span<const double>(x.data(), 15), reference), expected,
              1e-12 * expected);
  // Another prescribed part changes nothing.
  x += (Eigen::MatrixXd::Identity(15, 15) - s) * Eigen::VectorXd::Constant(15, 100.0);
  EXPECT_NEAR(anorm_error(c.system(), std::span<const double>(x.data(), 15), reference), expected,
              1e-10 * expected);
}

TEST(Reference, SaysWhyThereIsNone) {
  BlockCsr a = biharmonic(10);
  *a.block(4, a.pattern->diagonal[4]) = -1.0;
  std::vector<double> b(10, 1.0);
  LinearSystem system;
  system.matrix = &a, system.rhs = b;
  ReferenceReport report;
  EXPECT_TRUE(reference_solution(system, report).empty());
  EXPECT_EQ(report.status.outcome, Outcome::not_positive_definite);
  EXPECT_FALSE(report.status.message.empty());

  a = biharmonic(10);
  b[3] = NAN;
  EXPECT_TRUE(reference_solution(system, report).empty());
  EXPECT_EQ(report.status.outcome, Outcome::not_finite);
}

}  // namespace
}  // namespace taut
