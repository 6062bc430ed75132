#include "taut/solve/filtered_matrix.h"

#include "taut/base/parallel.h"
#include "taut/solve/node_scale.h"

namespace taut {

namespace {

void filter(const BlockCsr& a, const ConstraintSet* constraints, bool columns_too,
            BlockCsr& filtered) {
  filtered = a;
  if (!constraints) return;
  const BlockPattern& p = *a.pattern;
  const std::vector<double> scale = node_scale(a);
  using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  parallel_for(p.rows(), 256, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
        const Index j = p.column[k];
        const bool right = columns_too && constraints->ndof(j) < 3;
        if (constraints->ndof(i) == 3 && !right) continue;
        Eigen::Map<RowMajor3, 0, Eigen::OuterStride<>> block(filtered.block(i, k),
                                                             Eigen::OuterStride<>(p.width(i)));
        Mat3 value = constraints->projection(i) * block;
        if (right) value = Mat3(value * constraints->projection(j));
        if (i == j) value += scale[i] * (Mat3::Identity() - constraints->projection(i));
        block = value;
      }
  });
}

}  // namespace

void filter_matrix(const BlockCsr& a, const ConstraintSet* constraints, BlockCsr& filtered) {
  filter(a, constraints, true, filtered);
}

void filter_rows(const BlockCsr& a, const ConstraintSet* constraints, BlockCsr& filtered) {
  filter(a, constraints, false, filtered);
}

}  // namespace taut
