// Packed panels and the solves with them, front by front, against the dense triangle: every width
// of the first group, rows that end anywhere in a vector.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/random_matrix.h"
#include "taut/linalg/block_cholesky/runnable_kernels.h"

namespace taut::test {
namespace {

template <class T>
class FrontSolvesOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(FrontSolvesOf, Precisions);

FrontShape shape_of(Index pivots, Index rows_below, Index slab_rows, Index group) {
  FrontShape shape;
  shape.slab_rows = slab_rows;
  shape.columns = (pivots + group - 1) / group * group;
  shape.padding = shape.columns - pivots;
  shape.rows = shape.columns + rows_below;
  return shape;
}

// L of the front, rows x columns, with the identity in the padding.
Eigen::MatrixXd random_columns(const FrontShape& shape, Random& random) {
  Eigen::MatrixXd l = Eigen::MatrixXd::Zero(shape.rows, shape.columns);
  for (Index j = 0; j < shape.columns; ++j) {
    l(j, j) = j < shape.padding ? 1.0 : random.uniform(1.0, 2.0);
    for (Index i = j + 1; i < shape.rows && j >= shape.padding; ++i)
      l(i, j) = random.uniform(-0.2, 0.2);
  }
  return l;
}

// As eliminate() leaves it: slabs, the diagonal inverted.
template <class T>
std::vector<T> panel_of(const FrontShape& shape, const Eigen::MatrixXd& l) {
  std::vector<T> panel(static_cast<std::size_t>(shape.panel_size()), T(0));
  const Index r = shape.slab_rows;
  for (Index j = 0; j < shape.columns; ++j)
    for (Index i = j; i < shape.rows; ++i)
      panel[static_cast<std::size_t>(shape.panel_offset(i / r) + Offset{j} * r + i % r)] =
          static_cast<T>(i == j ? 1.0 / l(i, j) : l(i, j));
  return panel;
}

// Packed in two parts, between guards that must stay as they are.
template <class T>
std::vector<T> packed_of(const FrontKernels<T>& kernels, const FrontShape& shape,
                         const std::vector<T>& panel) {
  const Offset size = kernels.packed_size(shape), guard = 64 / sizeof(T);
  EXPECT_EQ(size % guard, 0);
  std::vector<T> packed(static_cast<std::size_t>(size + 2 * guard),
                        std::numeric_limits<T>::quiet_NaN());
  const Index half = shape.columns / kernels.column_group / 2 * kernels.column_group;
  kernels.pack(shape, panel.data(), packed.data() + guard, half, shape.columns);
  kernels.pack(shape, panel.data(), packed.data() + guard, 0, half);
  for (Offset k = 0; k < guard; ++k)
    EXPECT_TRUE(std::isnan(packed[k]) && std::isnan(packed[packed.size() - 1 - k]));
  return packed;
}

template <class T>
void expect_solves(const FrontKernels<T>& kernels, const FrontShape& shape, Random& random) {
  const Eigen::MatrixXd l = random_columns(shape, random);
  const std::vector<T> packed = packed_of(kernels, shape, panel_of<T>(shape, l));
  const T* values = packed.data() + 64 / sizeof(T);
  Eigen::VectorXd y = Eigen::VectorXd::Random(shape.rows);
  y.head(shape.padding).setZero();
  const Index n = shape.columns, m = shape.rows - n;
  const auto l11 = l.topRows(n).triangularView<Eigen::Lower>();
  Eigen::VectorXd expected = y;
  expected.head(n) = l11.solve(y.head(n));
  expected.tail(m) -= l.bottomRows(m) * expected.head(n);

  const double tolerance = sizeof(T) == 4 ? 3e-5 : 1e-13;
  std::vector<T> x(static_cast<std::size_t>(shape.vector_size()),
                   std::numeric_limits<T>::quiet_NaN());
  const auto error = [&] {
    double largest = 0.0;
    for (Index i = 0; i < shape.rows; ++i)
      largest = std::max(largest, std::abs(static_cast<double>(x[i]) - expected[i]));
    return largest / std::max(1.0, expected.cwiseAbs().maxCoeff());
  };
  for (Index i = 0; i < shape.rows; ++i) x[i] = static_cast<T>(y[i]);
  kernels.forward(shape, values, x.data());
  ASSERT_LT(error(), tolerance) << "forward, " << kernels.instruction_set << ", "
                                << n - shape.padding << " pivots, " << m << " rows below";

  for (Index i = 0; i < shape.rows; ++i) x[i] = static_cast<T>(y[i]);
  expected = y;
  expected.head(n) = l11.transpose().solve(y.head(n) - l.bottomRows(m).transpose() * y.tail(m));
  kernels.backward(shape, values, x.data());
  ASSERT_LT(error(), tolerance) << "backward, " << kernels.instruction_set << ", "
                                << n - shape.padding << " pivots, " << m << " rows below";
}

TYPED_TEST(FrontSolvesOf, AgainstDense) {
  Random random(7);
  for (const auto* kernels : runnable_front_kernels<TypeParam>())
    for (Index pivots = 1; pivots <= 3 * kernels->column_group + 1; ++pivots)
      for (Index below = 0; below <= kernels->slab_rows + 2; ++below) {
        expect_solves(*kernels, shape_of(pivots, below, kernels->slab_rows, kernels->column_group),
                      random);
        if (this->HasFatalFailure()) return;
      }
}

}  // namespace
}  // namespace taut::test
