// The solves of NumericFactor.

#include <algorithm>
#include <functional>

#include "taut/base/flush_subnormals.h"
#include "taut/base/simd.h"
#include "taut/linalg/block_cholesky/numeric_factor.h"
#include "taut/linalg/block_cholesky/quad.h"

namespace taut {

template <class T>
void NumericFactor<T>::solve_forward(const FactorVectors& vectors, const double* b) {
  const auto up = [&](Index t) {
    const FlushSubnormals flush;
    const Index end = layout_.task[t].end;
    for (Index s = layout_.task[t].begin; s < end; ++s) forward(s, vectors, b);
  };
  run_upwards(layout_.task_tree, std::ref(up));
}

template <class T>
void NumericFactor<T>::solve_backward(const FactorVectors& vectors, double beta, double* x) {
  const auto down = [&](Index t) {
    const FlushSubnormals flush;
    const Index begin = layout_.task[t].begin;
    for (Index s = layout_.task[t].end - 1; s >= begin; --s) backward(s, vectors, beta, x);
  };
  run_downwards(layout_.task_tree, std::ref(down));
}

namespace {

// A handful of numbers: too few to be worth a call. Reads and writes up to three more.
template <class T>
TAUT_ALWAYS_INLINE void copy_few(const T* from, Index count, T* to) {
  for (Index r = 0; r < count; r += 4) quad(to + r) = quad(from + r);
}

// x may be anything where beta is 0.
TAUT_ALWAYS_INLINE double sum_with(double value, double beta, double x) {
  return beta == 0.0 ? value : value + beta * x;
}

template <class T>
double norm2_of_entries(const T* begin, const T* end) {
  double sum[4] = {};
  const T* p = begin;
  for (; p + 4 <= end; p += 4)
    for (int i = 0; i < 4; ++i) sum[i] += static_cast<double>(p[i]) * static_cast<double>(p[i]);
  for (; p < end; ++p) sum[0] += static_cast<double>(*p) * static_cast<double>(*p);
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

}  // namespace

template <class T>
double NumericFactor<T>::norm2_of(int slot) const {
  double sum = 0.0;
  for (const double part : norm2_[slot]) sum += part;
  return sum;
}

template <class T>
void NumericFactor<T>::forward(Index s, const FactorVectors& vectors, const double* b, int slot) {
  const Front& front = layout_.front[s];
  T* const all = vectors_[slot].data();
  T* y = all + front.vector;
  std::fill(y, y + front.shape.rows, T(0));
  for (Index k = front.first_node; k < front.last_node; ++k) {
    const double* from = b + vectors.start[k];
    T* to = y + layout_.node_column[k];
    if (basis_of_[k] >= 0) {
      const Mat3& q = basis_[basis_of_[k]];
      for (Index r = 0; r < dim_[k]; ++r)
        to[r] = static_cast<T>(vectors.scale * q.col(r).dot(Eigen::Map<const Vec3>(from)));
    } else if (dim_[k] == 3) {
      for (Index r = 0; r < 3; ++r) to[r] = static_cast<T>(vectors.scale * from[r]);
    } else {
      for (Index r = 0; r < dim_[k]; ++r) to[r] = static_cast<T>(vectors.scale * from[r]);
    }
  }
  const double condensed_norm2 = forward_condensed(front, vectors, b, slot);
  for (Index i = front.child_begin; i < front.child_end; ++i) {
    const Front& child = layout_.front[layout_.child[i]];
    kernels_.add_rows(layout_.spread.data() + child.spread_begin,
                      child.spread_end - child.spread_begin, all + child.vector, y);
  }
  kernels_.forward(front.shape, packed_.data() + front.packed, y);
  norm2_[slot][s] =
      condensed_norm2 + norm2_of_entries(y + front.shape.padding, y + front.shape.columns);
}

template <class T>
void NumericFactor<T>::backward(Index s, const FactorVectors& vectors, double beta, double* x) {
  const Front& front = layout_.front[s];
  T* y = vectors_[0].data() + front.vector;
  if (front.parent >= 0) {
    const T* from = vectors_[0].data() + layout_.front[front.parent].vector;
    for (Index q = front.run_begin; q < front.run_end; ++q) {
      const RowRun& run = layout_.run[q];
      // what is too much is written over by the next
      copy_few(from + run.to, run.count, y + run.from);
    }
  }
  kernels_.backward(front.shape, packed_.data() + front.packed, y);
  const double scale = 1.0 / vectors.scale;
  for (Index k = front.first_node; k < front.last_node; ++k) {
    const T* from = y + layout_.node_column[k];
    double* to = x + vectors.start[k];
    if (basis_of_[k] >= 0) {
      Vec3 expanded = Vec3::Zero();
      for (Index r = 0; r < dim_[k]; ++r)
        expanded += static_cast<double>(from[r]) * basis_[basis_of_[k]].col(r);
      for (Index r = 0; r < 3; ++r) to[r] = sum_with(scale * expanded[r], beta, to[r]);
    } else if (dim_[k] == 3) {
      for (Index r = 0; r < 3; ++r)
        to[r] = sum_with(scale * static_cast<double>(from[r]), beta, to[r]);
    } else {
      for (Index r = 0; r < dim_[k]; ++r)
        to[r] = sum_with(scale * static_cast<double>(from[r]), beta, to[r]);
    }
  }
  backward_condensed(front, vectors, beta, x);
}

template void NumericFactor<float>::solve_forward(const FactorVectors&, const double*);
template void NumericFactor<double>::solve_forward(const FactorVectors&, const double*);
template void NumericFactor<float>::solve_backward(const FactorVectors&, double, double*);
template void NumericFactor<double>::solve_backward(const FactorVectors&, double, double*);
template double NumericFactor<float>::norm2_of(int) const;
template double NumericFactor<double>::norm2_of(int) const;
template void NumericFactor<float>::forward(Index, const FactorVectors&, const double*, int);
template void NumericFactor<double>::forward(Index, const FactorVectors&, const double*, int);

}  // namespace taut
