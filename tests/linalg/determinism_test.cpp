// The same bits for any number of threads: products, sums and whole solves. Large enough that every
// loop is really split.

#include <gtest/gtest.h>

#include "linalg/random_matrix.h"
#include "taut/base/parallel.h"
#include "taut/linalg/bicgstab.h"
#include "taut/linalg/block_cholesky.h"
#include "taut/linalg/eigen_cholesky.h"
#include "taut/linalg/pcg.h"
#include "taut/linalg/vector_ops.h"

namespace taut::test {
namespace {

constexpr Index nodes = 13'001;

class Determinism : public testing::Test {
 protected:
  ~Determinism() override { set_thread_count(before_); }

  // action() returns a vector of doubles, compared by bits (== would let 0 pass for -0, which is
  // harmless, and NaN never).
  template <class Action>
  void expect_same_bits(Action action) {
    set_thread_count(1);
    const std::vector<double> expected = action();
    ASSERT_TRUE(all_finite(expected));
    for (const int threads : {2, 3, 4}) {
      set_thread_count(threads);
      EXPECT_EQ(action(), expected) << threads << " threads";
    }
  }

  BlockCsr narrow_spd(bool mixed) {
    const auto graph = random_graph(random_, nodes, 2, 4);
    return random_spd(
        random_, mixed ? make_pattern(graph, random_dims(random_, nodes)) : make_pattern(graph, 3),
        0.02);
  }

  Random random_{1};

 private:
  const int before_ = thread_count();
};

TEST_F(Determinism, VectorOperations) {
  const std::vector<double> a = random_.vector(100'003), b = random_.vector(100'003);
  expect_same_bits([&] {
    std::vector<double> y = b;
    add_scaled(0.37, a, y);
    scale_add(-1.7, a, y);
    residual_from_product(b, y);
    y.push_back(dot(a, b));
    y.push_back(norm(y));
    return y;
  });
}

TEST_F(Determinism, Products) {
  for (const bool mixed : {false, true}) {
    const BlockCsr a = narrow_spd(mixed);
    const std::vector<double> x = random_.vector(a.dofs());
    expect_same_bits([&] {
      std::vector<double> y(x.size()), z(x.size());
      multiply(a, x, y);
      z.push_back(multiply_dot(a, y, std::span(z).first(y.size())));
      return z;
    });
  }
}

TEST_F(Determinism, ConjugateGradientSolves) {
  for (const bool mixed : {false, true}) {
    const BlockCsr a = narrow_spd(mixed);
    const std::vector<double> b = random_.vector(a.dofs());
    expect_same_bits([&] {
      std::vector<double> x(b.size(), 0.0);
      BlockDiagonalPreconditioner m;
      EXPECT_TRUE(m.update(a).ok());
      const KrylovResult result = pcg(BlockCsrOperator(a), m, b, x, {1e-6, 100, {}});
      EXPECT_TRUE(result.status.ok());
      x.push_back(result.iterations), x.push_back(result.stop_value);
      return x;
    });
  }
}

TEST_F(Determinism, BicgstabSolves) {
  const BlockCsr a = narrow_spd(true);
  const std::vector<double> b = random_.vector(a.dofs());
  expect_same_bits([&] {
    std::vector<double> x(b.size(), 0.0);
    DiagonalPreconditioner m;
    EXPECT_TRUE(m.update(a).ok());
    EXPECT_TRUE(bicgstab(BlockCsrOperator(a), m, b, x, {1e-6, 100, {}}).status.ok());
    return x;
  });
}

TEST_F(Determinism, DirectSolves) {
  const BlockCsr a = narrow_spd(false);
  const std::vector<double> b = random_.vector(a.dofs());
  expect_same_bits([&] {
    std::vector<double> x(b.size());
    EigenCholesky cholesky;
    EXPECT_TRUE(cholesky.analyze(a).ok() && cholesky.factorize(a).ok() &&
                cholesky.solve(b, x).ok());
    return x;
  });
}

// A square grid, whose upper fronts are large enough to be shared between threads.
BlockCsr grid_spd(Random& random, Index side) {
  std::vector<std::vector<Index>> columns;
  for (Index i = 0; i < side * side; ++i) {
    columns.emplace_back();
    if (i % side > 0) columns.back().push_back(i - 1);
    if (i % side < side - 1) columns.back().push_back(i + 1);
    if (i >= side) columns.back().push_back(i - side);
    if (i < side * (side - 1)) columns.back().push_back(i + side);
  }
  return random_spd(random, make_pattern(columns, 3), 0.02);
}

TEST_F(Determinism, BlockCholesky) {
  const BlockCsr a = grid_spd(random_, 110);
  const std::vector<double> b = random_.vector(a.dofs());
  for (const auto precision :
       {CholeskyPrecision::double_precision, CholeskyPrecision::single_precision}) {
    // One analysis serves all: the plan of the tasks follows the number of threads.
    taut::BlockCholesky cholesky(precision);
    ASSERT_TRUE(cholesky.analyze(a.pattern, {}).ok());
    expect_same_bits([&] {
      std::vector<double> x(b.size());
      double norm2 = 0.0;
      EXPECT_TRUE(cholesky.factorize(a, {}, b, &norm2).ok());
      EXPECT_EQ(cholesky.solve_forward(b), norm2);
      cholesky.solve_backward(0.0, x);
      x.push_back(norm2);
      return x;
    });
  }
}

}  // namespace
}  // namespace taut::test
