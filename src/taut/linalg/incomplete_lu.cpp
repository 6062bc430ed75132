#include "taut/linalg/incomplete_lu.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>

#include "taut/linalg/small_block.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

namespace {

template <int n>
bool invert_pivot(const double* block, double* inverse) {
  using Small = Eigen::Matrix<double, n, n, n == 1 ? Eigen::ColMajor : Eigen::RowMajor>;
  const Eigen::Map<const Small> b(block);
  const Eigen::PartialPivLU<Small> lu(b);
  if (!b.allFinite() || !(lu.rcond() > 1e-14)) return false;
  Eigen::Map<Small> result(inverse);
  result = lu.inverse();
  return true;
}

// Row by row (the IKJ variant): W = A's row; for each k before i: L_ik = W_ik
// D_k⁻¹, W_ij -= W_ik U_kj.
template <int n>
class Elimination {
 public:
  Elimination(const BlockCsr& a, BlockLdu& factor)
      : a_(a), factor_(factor), layout_(factor.layout()), slot_(layout_.node.size(), nullptr) {}

  Index run() {
    for (Index p = 0; p < layout_.places(); ++p)
      if (!row(p)) return layout_.node[p];
    return -1;
  }

 private:
  bool row(Index p) {
    const Index i = layout_.node[p];
    double diagonal[n * n], scaled[n * n];
    load_padded(a_, i, a_.pattern->diagonal[i], n, diagonal);
    slot_[p] = diagonal;
    for_each_block(p, [&](double* block, Index column, Index source) {
      load_padded(a_, i, source, n, block);
      slot_[column] = block;
    });
    for (Index k = layout_.lower.start[p]; k < layout_.lower.start[p + 1]; ++k) {
      const Index j = layout_.lower.column[k];
      double* w = factor_.lower(k);
      for (Index m = layout_.upper.start[j]; m < layout_.upper.start[j + 1]; ++m)
        if (double* target = slot_[layout_.upper.column[m]])
          subtract_product<n>(w, factor_.upper(m), target);
      product<n>(w, factor_.inverse_diagonal(j), scaled);
      std::copy(scaled, scaled + n * n, w);
    }
    slot_[p] = nullptr;
    for_each_block(p, [&](double*, Index column, Index) { slot_[column] = nullptr; });
    if (!invert_pivot<n>(diagonal, factor_.inverse_diagonal(p))) return false;
    for (Index k = layout_.upper.start[p]; k < layout_.upper.start[p + 1]; ++k) {
      product<n>(factor_.inverse_diagonal(p), factor_.upper(k), scaled);
      std::copy(scaled, scaled + n * n, factor_.upper(k));
    }
    return true;
  }

  template <class Visit>
  void for_each_block(Index p, Visit visit) {
    const TriangularRows &lower = layout_.lower, &upper = layout_.upper;
    for (Index k = lower.start[p]; k < lower.start[p + 1]; ++k)
      visit(factor_.lower(k), lower.column[k], lower.source[k]);
    for (Index k = upper.start[p]; k < upper.start[p + 1]; ++k)
      visit(factor_.upper(k), upper.column[k], upper.source[k]);
  }

  const BlockCsr& a_;
  BlockLdu& factor_;
  const TriangularLayout& layout_;
  std::vector<double*> slot_;  // where the row at hand keeps its block of a column, or null
};

}  // namespace

Status BlockIncompleteLu::update(const BlockCsr& a) {
  factor_.set_pattern(a.pattern, false);
  const Index broken = factor_.layout().block == 1 ? Elimination<1>(a, factor_).run()
                                                   : Elimination<3>(a, factor_).run();
  if (broken < 0) return {};
  if (!all_finite(a.values)) return {Outcome::not_finite, "the matrix holds NaN or infinity"};
  return {
      Outcome::breakdown,
      fmt::format("ILU(0) breaks down: the diagonal block of node {} becomes singular", broken)};
}

}  // namespace taut
