// The solves of NumericFactor.

#include <algorithm>
#include <functional>

#include "taut/base/parallel.h"
#include "taut/linalg/block_cholesky/numeric_factor.h"

namespace taut {

namespace {

// Asks for the begin of a front's panel while the front before it is worked on: most fronts are smaller than a stream that the processor
// would recognise.
template <class T>
void prefetch_panel(const FrontShape& shape, const T* panel) {
  constexpr Offset line = 64 / sizeof(T), most = 16384 / sizeof(T);
  const Offset size = std::min(shape.panel_size(), most);
  for (Offset k = 0; k < size; k += line) __builtin_prefetch(panel + k, 0, 2);
}

}  // namespace

template <class T>
void NumericFactor<T>::solve_forward(const FactorVectors& vectors, const double* b) {
  const auto up = [&](Index t) {
    for (Index s = layout_.task[t].begin; s < layout_.task[t].end; ++s) {
      if (s + 1 < layout_.task[t].end) prefetch_panel(layout_.front[s + 1].shape, panels_.data() + layout_.front[s + 1].panel);
      forward(s, vectors, b);
    }
  };
  run_upwards(layout_.task_tree, std::ref(up));
}

template <class T>
void NumericFactor<T>::solve_backward(const FactorVectors& vectors, double beta, double* x) {
  const auto down = [&](Index t) {
    for (Index s = layout_.task[t].end - 1; s >= layout_.task[t].begin; --s) {
      if (s > layout_.task[t].begin) prefetch_panel(layout_.front[s - 1].shape, panels_.data() + layout_.front[s - 1].panel);
      backward(s, vectors, beta, x);
    }
  };
  run_downwards(layout_.task_tree, std::ref(down));
}

template <class T>
double NumericFactor<T>::norm2_of(const std::vector<double>& parts) {
  double sum = 0.0;
  for (const double part : parts) sum += part;
  return sum;
}

template <class T>
void NumericFactor<T>::forward(Index s, const FactorVectors& vectors, const double* b, int slot) {
  const Front& front = layout_.front[s];
  T* const all = vectors_[slot].data();
  T* y = all + front.vector;
  std::fill(y, y + Offset{front.shape.slabs()} * front.shape.slab_rows, T(0));
  for (Index k = front.first_node; k < front.last_node; ++k) {
    const double* from = b + vectors.start[k];
    T* to = y + layout_.node_column[k];
    if (basis_of_[k] < 0) {
      for (Index r = 0; r < dim_[k]; ++r) to[r] = static_cast<T>(vectors.scale * from[r]);
    } else {
      const Mat3& q = basis_[basis_of_[k]];
      for (Index r = 0; r < dim_[k]; ++r) to[r] = static_cast<T>(vectors.scale * q.col(r).dot(Eigen::Map<const Vec3>(from)));
    }
  }
  for (Index i = front.child_begin; i < front.child_end; ++i) {
    const Front& child = layout_.front[layout_.child[i]];
    const T* from = all + child.vector;
    for (Index q = child.piece_begin; q < child.piece_end; ++q) {
      const RowPiece& piece = layout_.piece[q];
      for (Index r = 0; r < piece.count; ++r) y[piece.to + r] += from[piece.from + r];
    }
  }
  kernels_.forward(front.shape, panels_.data() + front.panel, y);
  double sum = 0.0;
  for (Index i = 0; i < front.pivots; ++i) sum += static_cast<double>(y[i]) * static_cast<double>(y[i]);
  norm2_[slot][s] = sum;
}

template <class T>
void NumericFactor<T>::backward(Index s, const FactorVectors& vectors, double beta, double* x) {
  const Front& front = layout_.front[s];
  T* y = vectors_[0].data() + front.vector;
  if (front.parent >= 0) {
    const T* from = vectors_[0].data() + layout_.front[front.parent].vector;
    for (Index q = front.piece_begin; q < front.piece_end; ++q) {
      const RowPiece& piece = layout_.piece[q];
      std::copy(from + piece.to, from + piece.to + piece.count, y + piece.from);
    }
  }
  kernels_.backward(front.shape, panels_.data() + front.panel, y);
  const double scale = 1.0 / vectors.scale;
  for (Index k = front.first_node; k < front.last_node; ++k) {
    const T* from = y + layout_.node_column[k];
    double* to = x + vectors.start[k];
    Index count = dim_[k];
    Vec3 expanded = Vec3::Zero();
    if (basis_of_[k] >= 0) {
      for (Index r = 0; r < dim_[k]; ++r) expanded += static_cast<double>(from[r]) * basis_[basis_of_[k]].col(r);
      count = 3;
    }
    for (Index r = 0; r < count; ++r) {
      const double value = scale * (basis_of_[k] >= 0 ? expanded[r] : static_cast<double>(from[r]));
      to[r] = beta == 0.0 ? value : value + beta * to[r];
    }
  }
}

template void NumericFactor<float>::solve_forward(const FactorVectors&, const double*);
template void NumericFactor<double>::solve_forward(const FactorVectors&, const double*);
template void NumericFactor<float>::solve_backward(const FactorVectors&, double, double*);
template void NumericFactor<double>::solve_backward(const FactorVectors&, double, double*);
template double NumericFactor<float>::norm2_of(const std::vector<double>&);
template double NumericFactor<double>::norm2_of(const std::vector<double>&);
template void NumericFactor<float>::forward(Index, const FactorVectors&, const double*, int);
template void NumericFactor<double>::forward(Index, const FactorVectors&, const double*, int);

}  // namespace taut
