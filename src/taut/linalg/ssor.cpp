#include "taut/linalg/ssor.h"

#include <cassert>

#include "taut/linalg/small_block.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

namespace {

// With D' = D/ω: M = (I + L D'⁻¹) D'/(2-ω) (I + L D'⁻¹)ᵀ. False if the diagonal block of node
// `broken` is not positive definite.
template <int n>
bool fill(const BlockCsr& a, double omega, BlockLdu& factor, Index& broken) {
  const TriangularLayout& layout = factor.layout();
  for (Index p = 0; p < layout.places(); ++p) {
    const Index i = layout.node[p];
    double block[n * n];
    load_padded(a, i, a.pattern->diagonal[i], n, block);
    for (double& value : block) value /= omega;
    if (!invert_small(block, n, n, factor.inverse_diagonal(p))) return broken = i, false;
    for (Index k = layout.lower.start[p]; k < layout.lower.start[p + 1]; ++k) {
      load_padded(a, i, layout.lower.source[k], n, block);
      product<n>(block, factor.inverse_diagonal(layout.lower.column[k]), factor.lower(k));
    }
  }
  for (Index p = 0; p < layout.places(); ++p)
    for (int c = 0; c < n * n; ++c) factor.inverse_diagonal(p)[c] *= 2.0 - omega;
  return true;
}

}  // namespace

BlockSsor::BlockSsor(double omega) : omega_(omega) { assert(omega > 0.0 && omega < 2.0); }

Status BlockSsor::update(const BlockCsr& a) {
  factor_.set_pattern(a.pattern, true);
  Index broken = -1;
  const bool filled = factor_.layout().block == 1 ? fill<1>(a, omega_, factor_, broken)
                                                  : fill<3>(a, omega_, factor_, broken);
  return filled ? Status{} : bad_diagonal_block(a, broken);
}

}  // namespace taut
