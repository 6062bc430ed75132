// The solves of NumericFactor.

#include <algorithm>
#include <functional>

#include "taut/base/parallel.h"
#include "taut/linalg/block_cholesky/numeric_factor.h"

namespace taut {

template <class T>
void NumericFactor<T>::solve(std::span<const Index> start, std::span<const double> b, std::span<double> x) {
  const auto up = [&](Index t) {
    for (Index s = layout_.task[t].begin; s < layout_.task[t].end; ++s) forward(layout_.front[s], start, b.data());
  };
  const auto down = [&](Index t) {
    for (Index s = layout_.task[t].end - 1; s >= layout_.task[t].begin; --s) backward(layout_.front[s], start, x.data());
  };
  run_upwards(layout_.task_tree, std::ref(up));
  run_downwards(layout_.task_tree, std::ref(down));
}

template <class T>
void NumericFactor<T>::forward(const Front& front, std::span<const Index> start, const double* b) {
  T* y = vectors_.data() + front.vector;
  std::fill(y, y + Offset{front.shape.slabs()} * front.shape.slab_rows, T(0));
  for (Index k = front.first_node; k < front.last_node; ++k)
    for (Index r = 0; r < dim_[k]; ++r) y[layout_.node_column[k] + r] = static_cast<T>(b[start[k] + r]);
  for (Index i = front.child_begin; i < front.child_end; ++i) {
    const Front& child = layout_.front[layout_.child[i]];
    const T* from = vectors_.data() + child.vector;
    for (Index q = child.piece_begin; q < child.piece_end; ++q) {
      const RowPiece& piece = layout_.piece[q];
      for (Index r = 0; r < piece.count; ++r) y[piece.to + r] += from[piece.from + r];
    }
  }
  kernels_.forward(front.shape, panels_.data() + front.panel, y);
}

template <class T>
void NumericFactor<T>::backward(const Front& front, std::span<const Index> start, double* x) {
  T* y = vectors_.data() + front.vector;
  if (front.parent >= 0) {
    const T* from = vectors_.data() + layout_.front[front.parent].vector;
    for (Index q = front.piece_begin; q < front.piece_end; ++q) {
      const RowPiece& piece = layout_.piece[q];
      std::copy(from + piece.to, from + piece.to + piece.count, y + piece.from);
    }
  }
  kernels_.backward(front.shape, panels_.data() + front.panel, y);
  for (Index k = front.first_node; k < front.last_node; ++k)
    for (Index r = 0; r < dim_[k]; ++r) x[start[k] + r] = static_cast<double>(y[layout_.node_column[k] + r]);
}

template void NumericFactor<float>::solve(std::span<const Index>, std::span<const double>, std::span<double>);
template void NumericFactor<double>::solve(std::span<const Index>, std::span<const double>, std::span<double>);

}  // namespace taut
