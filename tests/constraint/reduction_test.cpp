#include "taut/constraint/reduction.h"

#include <gtest/gtest.h>

#include "linalg/random_matrix.h"
#include "taut/base/parallel.h"

namespace taut::test {
namespace {

// ndof 0..3 at random, or all nodes as `only` says; normals now and then at the poles of both frame
// constructions.
ConstraintSet random_constraints(Random& random, Index nodes, FrameChoice choice, int only = -1) {
  ConstraintSet set(nodes, choice);
  const Vec3 poles[] = {Vec3::UnitX(),  -Vec3::UnitX(), Vec3::UnitY(),
                        -Vec3::UnitY(), Vec3::UnitZ(),  -Vec3::UnitZ()};
  for (Index i = 0; i < nodes; ++i) {
    const int ndof = only >= 0 ? only : random.below(4);
    if (ndof == 0) set.fix(i, Vec3::Zero());
    while (set.ndof(i) > ndof)
      set.constrain(i, random.below(3) == 0 ? poles[random.below(6)] : random.direction(),
                    random.uniform());
  }
  return set;
}

Eigen::MatrixXd dense_u(const ConstraintSet& set) {
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(3 * set.nodes(), set.free_dofs());
  Index column = 0;
  for (Index i = 0; i < set.nodes(); ++i)
    for (int c = 0; c < set.ndof(i); ++c) u.block<3, 1>(3 * i, column++) = set.frame(i).col(c);
  return u;
}

double difference(const BlockCsr& a, const Eigen::MatrixXd& expected) {
  EXPECT_EQ(a.dofs(), expected.rows());
  if (a.dofs() != expected.rows()) return HUGE_VAL;
  return (dense(a) - expected).norm() / std::max(1.0, expected.norm());
}

constexpr FrameChoice choices[] = {FrameChoice::duff, FrameChoice::paper_eq13};

TEST(Reduction, MatrixIsUtAU) {
  Random random(1);
  for (const FrameChoice choice : choices)
    for (const int only : {-1, 0, 1, 2, 3}) {
      // any matrix, not only symmetric ones
      const BlockCsr a = random_matrix(random, make_pattern(random_graph(random, 40, 3, 15), 3));
      const ConstraintSet set = random_constraints(random, 40, choice, only);
      const Eigen::MatrixXd u = dense_u(set);
      ASSERT_LT((u.transpose() * u - Eigen::MatrixXd::Identity(u.cols(), u.cols())).norm(), 1e-13);
      Reduction reduction;
      reduction.update(a, &set);
      EXPECT_LT(difference(reduction.matrix(), u.transpose() * dense(a) * u), 1e-14);
      EXPECT_EQ(reduction.matrix().rows(), 40);  // node numbers stay
    }
}

TEST(Reduction, AddsNoNonzeros) {
  Random random(2);
  const BlockCsr a = random_matrix(random, make_pattern(random_graph(random, 40, 3, 15), 3));
  const ConstraintSet set = random_constraints(random, 40, FrameChoice::duff);
  Reduction reduction;
  reduction.update(a, &set);
  const BlockPattern &from = *a.pattern, &to = *reduction.matrix().pattern;
  for (Index i = 0; i < 40; ++i)
    for (Index j = 0; j < 40; ++j) {
      const bool both_free = set.ndof(i) > 0 && set.ndof(j) > 0;
      EXPECT_EQ(to.find(i, j) >= 0, i == j || (both_free && from.find(i, j) >= 0));
    }
}

TEST(Reduction, MaskKeepsTheCore) {
  Random random(3);
  for (const bool constrained : {false, true}) {
    const BlockCsr a = random_matrix(random, make_pattern(random_graph(random, 40, 3, 15), 3));
    const BlockPattern& p = *a.pattern;
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(p.blocks()));
    Eigen::MatrixXd core = dense(a);
    for (Index i = 0; i < p.rows(); ++i)
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
        mask[k] = p.column[k] == i || random.below(2);
        if (!mask[k]) core.block<3, 3>(3 * i, 3 * p.column[k]).setZero();
      }
    const ConstraintSet set = random_constraints(random, 40, FrameChoice::duff);
    Reduction reduction;
    reduction.update(a, constrained ? &set : nullptr, mask);
    const Eigen::MatrixXd u = dense_u(set);
    EXPECT_LT(difference(reduction.matrix(), constrained ? u.transpose() * core * u : core), 1e-14);
    // Deleted, not only zeroed.
    if (!constrained) {
      EXPECT_EQ(reduction.matrix().pattern->blocks(), std::ranges::count(mask, 1));
    }
  }
}

TEST(Reduction, PatternIsRebuiltOnlyWhenItChanges) {
  Random random(4);
  BlockCsr a = random_matrix(random, make_pattern(random_graph(random, 30, 3, 15), 3));
  ConstraintSet set(30);
  set.constrain(3, Vec3(1, 2, 3), 0.0);
  set.fix(5, Vec3::Zero());
  Reduction reduction;
  EXPECT_TRUE(reduction.update(a, &set));
  const auto pattern = reduction.matrix().pattern;
  const auto expect_current = [&](const ConstraintSet* constraints) {
    const Eigen::MatrixXd u =
        constraints ? dense_u(*constraints) : Eigen::MatrixXd::Identity(90, 90);
    EXPECT_LT(difference(reduction.matrix(), u.transpose() * dense(a) * u), 1e-14);
  };

  // New values, and another normal with the same number of free directions: only numbers change.
  for (double& value : a.values) value = random.uniform();
  ConstraintSet turned(30);
  turned.constrain(3, Vec3(-2, 0, 1), 0.0);
  turned.fix(5, Vec3::Ones());
  EXPECT_FALSE(reduction.update(a, &turned));
  EXPECT_EQ(reduction.matrix().pattern, pattern);
  expect_current(&turned);

  turned.constrain(3, Vec3(0, 1, 0), 0.0);
  EXPECT_TRUE(reduction.update(a, &turned));
  expect_current(&turned);
  EXPECT_TRUE(reduction.update(a, nullptr));
  expect_current(nullptr);
  EXPECT_FALSE(reduction.update(a, nullptr));
  EXPECT_TRUE(reduction.update(a, &set));
  expect_current(&set);

  std::vector<std::uint8_t> mask(static_cast<std::size_t>(a.pattern->blocks()), 1);
  EXPECT_TRUE(reduction.update(a, &set, mask));
  EXPECT_FALSE(reduction.update(a, &set, mask));
  mask[1] = 0;
  EXPECT_TRUE(reduction.update(a, &set, mask));

  const BlockCsr other = random_matrix(random, make_pattern(random_graph(random, 30, 3, 15), 3));
  EXPECT_TRUE(reduction.update(other, &set));
}

TEST(Reduction, WithoutConstraintsIsACopyOfAnyMatrix) {
  Random random(5);
  for (const Index dim : {1, 3, 0}) {  // 0: mixed
    const auto graph = random_graph(random, 30, 3, 15);
    const BlockCsr a = random_matrix(
        random, dim ? make_pattern(graph, dim) : make_pattern(graph, random_dims(random, 30)));
    Reduction reduction;
    EXPECT_TRUE(reduction.update(a, nullptr));
    EXPECT_EQ(dense(reduction.matrix()), dense(a));
    const std::vector<double> v = random.vector(a.dofs());
    std::vector<double> w(v.size());
    restrict_to_free(nullptr, v, w);
    EXPECT_EQ(w, v);
    w.assign(w.size(), 0.0);
    prolong(nullptr, v, {}, w);
    EXPECT_EQ(w, v);
    project_free(nullptr, w);
    EXPECT_EQ(w, v);
    project_constrained(nullptr, w);
    EXPECT_EQ(w, std::vector<double>(v.size(), 0.0));
  }
}

TEST(Reduction, VectorsAgainstDense) {
  Random random(6);
  for (const FrameChoice choice : choices)
    for (const int only : {-1, 0, 1, 2, 3}) {
      const ConstraintSet set = random_constraints(random, 50, choice, only);
      const Eigen::MatrixXd u = dense_u(set);
      const Eigen::MatrixXd s = u * u.transpose();
      const Eigen::MatrixXd i_minus_s = Eigen::MatrixXd::Identity(150, 150) - s;
      const std::vector<double> full = random.vector(150), z = random.vector(150),
                                reduced = random.vector(set.free_dofs());

      std::vector<double> restricted(reduced.size());
      restrict_to_free(&set, full, restricted);
      EXPECT_LE((as_eigen(restricted) - u.transpose() * as_eigen(full)).norm(), 1e-14);
      std::vector<double> prolonged(150, 1e300);
      prolong(&set, reduced, z, prolonged);
      EXPECT_LE((as_eigen(prolonged) - (u * as_eigen(reduced) + i_minus_s * as_eigen(z))).norm(),
                1e-13);
      std::vector<double> v = full;
      project_free(&set, v);
      EXPECT_LE((as_eigen(v) - s * as_eigen(full)).norm(), 1e-13);
      v = full;
      project_constrained(&set, v);
      EXPECT_LE((as_eigen(v) - i_minus_s * as_eigen(full)).norm(), 1e-13);
    }
}

TEST(Reduction, DeterministicInTheNumberOfThreads) {
  Random random(7);
  const BlockCsr a = random_matrix(random, make_pattern(random_graph(random, 5000, 3, 15), 3));
  const ConstraintSet set = random_constraints(random, 5000, FrameChoice::duff);
  const int before = thread_count();
  Reduction reduction;
  set_thread_count(1);
  reduction.update(a, &set);
  const LargeVector<double> expected = reduction.matrix().values;
  for (const int threads : {2, 3, 4}) {
    set_thread_count(threads);
    reduction.update(a, &set);
    EXPECT_EQ(reduction.matrix().values, expected);
  }
  set_thread_count(before);
}

}  // namespace
}  // namespace taut::test
