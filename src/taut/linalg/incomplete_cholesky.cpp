#include "taut/linalg/incomplete_cholesky.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/linalg/small_block.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

namespace {

// One row after the other; `slot` says where a column stands in the row at hand.
template <int n>
class Factorization {
 public:
  Factorization(const BlockCsr& a, double shift, BlockLdu& factor)
      : a_(a),
        growth_(1.0 + shift),
        factor_(factor),
        layout_(factor.layout()),
        slot_(layout_.node.size(), -1) {}

  Index run() {
    for (Index p = 0; p < layout_.places(); ++p)
      if (!row(p)) return layout_.node[p];
    return -1;
  }

 private:
  bool row(Index p) {
    const TriangularRows& lower = layout_.lower;
    const Index begin = lower.start[p], end = lower.start[p + 1], i = layout_.node[p];
    w_.resize(static_cast<std::size_t>(end - begin) * n * n);
    for (Index k = begin; k < end; ++k) slot_[lower.column[k]] = k - begin;
    double diagonal[n * n];
    load_padded(a_, i, a_.pattern->diagonal[i], n, diagonal);
    for (double& value : diagonal) value *= growth_;
    for (Index k = begin; k < end; ++k) {
      double* w = w_of(k - begin);
      const Index j = lower.column[k];
      load_padded(a_, i, lower.source[k], n, w);
      for (Index m = lower.start[j]; m < lower.start[j + 1]; ++m)
        if (const Index both = slot_[lower.column[m]]; both >= 0)
          subtract_product_transposed<n>(w_of(both), factor_.lower(m), w);
      product<n>(w, factor_.inverse_diagonal(j), factor_.lower(k));
      subtract_product_transposed<n>(factor_.lower(k), w, diagonal);
    }
    for (Index k = begin; k < end; ++k) slot_[lower.column[k]] = -1;
    return invert_small(diagonal, n, n, factor_.inverse_diagonal(p));
  }
  double* w_of(Index slot) { return &w_[static_cast<std::size_t>(slot) * n * n]; }

  const BlockCsr& a_;
  double growth_;
  BlockLdu& factor_;
  const TriangularLayout& layout_;
  std::vector<Index> slot_;
  std::vector<double> w_;
};

}  // namespace

Index BlockIncompleteCholesky::factorize(const BlockCsr& a, double shift) {
  ++factorizations_;
  shift_ = shift;
  return factor_.layout().block == 1 ? Factorization<1>(a, shift, factor_).run()
                                     : Factorization<3>(a, shift, factor_).run();
}

Status BlockIncompleteCholesky::update(const BlockCsr& a) {
  factor_.set_pattern(a.pattern, true);
  factorizations_ = 0;
  broken_node_ = factorize(a, 0.0);
  return broken_node_ < 0 ? Status{} : find_shift(a, broken_node_);
}

Status BlockIncompleteCholesky::find_shift(const BlockCsr& a, Index broken_node) {
  if (!all_finite(a.values)) return {Outcome::not_finite, "the matrix holds NaN or infinity"};
  // No shift by these blocks can mend one that is not positive definite itself.
  BlockDiagonalPreconditioner blocks;
  if (Status status = blocks.update(a); !status.ok()) return status;
  double works = first_shift, fails = 0.5 * first_shift;
  for (; factorize(a, works) >= 0; fails = works, works *= 2.0)
    if (works > largest_shift)
      return {Outcome::not_positive_definite,
              fmt::format("IC(0) breaks down at node {} and no shift up to {:g} mends it: the "
                          "matrix is not positive definite",
                          broken_node, works)};
  for (int round = 0; round < shift_refinements; ++round) {
    const double middle = std::sqrt(fails * works);
    (factorize(a, middle) < 0 ? works : fails) = middle;
  }
  if (shift_ != works) factorize(a, works);
  return {};
}

std::string BlockIncompleteCholesky::remark() const {
  if (shift_ == 0.0) return {};
  return fmt::format(
      "IC(0) broke down at node {}: diagonal blocks raised by {:.3g} ({} factorisations)",
      broken_node_, shift_, factorizations_);
}

}  // namespace taut
