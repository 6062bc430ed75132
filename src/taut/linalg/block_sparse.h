#pragma once
// A sparse matrix of R x C blocks, all of one size known to the compiler: prolongators and coarse
// matrices of multigrid. BlockCsr is for the system.
//
//   row i   has the blocks k = start[i] ... start[i+1]-1, in columns column[k], in no particular
//           order; values[k] is row-major

#include <Eigen/Core>
#include <vector>

#include "taut/base/parallel.h"
#include "taut/base/types.h"

namespace taut {

template <int R, int C>
struct BlockSparse {
  using Block = Eigen::Matrix<double, R, C, (C == 1 && R > 1) ? Eigen::ColMajor : Eigen::RowMajor>;

  Index columns = 0;
  std::vector<Index> start{0};
  std::vector<Index> column;
  std::vector<Block> values;

  Index rows() const { return static_cast<Index>(start.size()) - 1; }
  Offset bytes() const {
    return static_cast<Offset>((start.size() + column.size()) * sizeof(Index) +
                               values.size() * sizeof(Block));
  }
};

// Collects one row of a product: add(j) is the block of column j, zero when new; flush() appends
// the row to `target`.
template <int R, int C>
class RowCollector {
 public:
  explicit RowCollector(BlockSparse<R, C>& target)
      : target_(target), slot_(static_cast<std::size_t>(target.columns), -1) {}
  typename BlockSparse<R, C>::Block& add(Index j) {
    if (slot_[j] < 0) {
      slot_[j] = static_cast<Index>(target_.column.size());
      target_.column.push_back(j);
      target_.values.push_back(BlockSparse<R, C>::Block::Zero());
    }
    return target_.values[slot_[j]];
  }
  void flush() {
    for (std::size_t k = static_cast<std::size_t>(target_.start.back()); k < target_.column.size();
         ++k)
      slot_[target_.column[k]] = -1;
    target_.start.push_back(static_cast<Index>(target_.column.size()));
  }

 private:
  BlockSparse<R, C>& target_;
  std::vector<Index> slot_;
};

// A B
template <int R, int K, int C>
BlockSparse<R, C> product(const BlockSparse<R, K>& a, const BlockSparse<K, C>& b) {
  BlockSparse<R, C> result;
  result.columns = b.columns;
  RowCollector<R, C> row(result);
  for (Index i = 0; i < a.rows(); ++i) {
    for (Index k = a.start[i]; k < a.start[i + 1]; ++k)
      for (Index m = b.start[a.column[k]]; m < b.start[a.column[k] + 1]; ++m)
        row.add(b.column[m]).noalias() += a.values[k] * b.values[m];
    row.flush();
  }
  return result;
}

template <int R, int C>
BlockSparse<C, R> transposed(const BlockSparse<R, C>& a) {
  BlockSparse<C, R> result;
  result.columns = a.rows();
  result.start.assign(static_cast<std::size_t>(a.columns) + 1, 0);
  for (const Index j : a.column) ++result.start[j + 1];
  for (Index j = 0; j < a.columns; ++j) result.start[j + 1] += result.start[j];
  result.column.resize(a.column.size()), result.values.resize(a.values.size());
  std::vector<Index> next(result.start.begin(), result.start.end() - 1);
  for (Index i = 0; i < a.rows(); ++i)
    for (Index k = a.start[i]; k < a.start[i + 1]; ++k) {
      const Index at = next[a.column[k]]++;
      result.column[at] = i;
      result.values[at] = a.values[k].transpose();
    }
  return result;
}

// y = A x, or y += A x
template <int R, int C>
void multiply(const BlockSparse<R, C>& a, const double* x, double* y, bool add = false) {
  parallel_for(a.rows(), 512, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      Eigen::Map<Eigen::Matrix<double, R, 1>> out(y + R * static_cast<std::ptrdiff_t>(i));
      Eigen::Matrix<double, R, 1> sum = Eigen::Matrix<double, R, 1>::Zero();
      if (add) sum = out;
      for (Index k = a.start[i]; k < a.start[i + 1]; ++k)
        sum.noalias() += a.values[k] * Eigen::Map<const Eigen::Matrix<double, C, 1>>(
                                           x + C * static_cast<std::ptrdiff_t>(a.column[k]));
      out = sum;
    }
  });
}

}  // namespace taut
