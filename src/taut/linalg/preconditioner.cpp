#include "taut/linalg/preconditioner.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>

#include "taut/base/parallel.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

namespace {

constexpr Index nodes_per_task = 4096;

Status bad_diagonal(Index i, double value) {
  const Outcome outcome =
      std::isfinite(value) ? Outcome::not_positive_definite : Outcome::not_finite;
  return {outcome, fmt::format("diagonal entry of unknown {} is {}; it must be positive and finite",
                               i, value)};
}

template <int dim>
bool invert_fixed(const double* block, Index stride, double* inverse) {
  using Small = Eigen::Matrix<double, dim, dim>;
  Small a;
  for (int r = 0; r < dim; ++r)
    for (int c = 0; c < dim; ++c) a(r, c) = block[r * stride + c];
  const Eigen::LLT<Small> factor(a);
  if (factor.info() != Eigen::Success || !a.allFinite()) return false;
  const Small b = factor.solve(Small::Identity());
  for (int r = 0; r < dim; ++r)
    for (int c = 0; c < dim; ++c) inverse[r * dim + c] = 0.5 * (b(r, c) + b(c, r));
  return true;
}

}  // namespace

Status bad_diagonal_block(const BlockCsr& a, Index node) {
  const BlockPattern& p = *a.pattern;
  const double* block = a.block(node, p.diagonal[node]);
  for (Index r = 0; r < p.dim(node); ++r)
    if (!all_finite({block + r * p.width(node), static_cast<std::size_t>(p.dim(node))}))
      return {Outcome::not_finite,
              fmt::format("the diagonal block of node {} is not finite", node)};
  return {Outcome::not_positive_definite,
          fmt::format("the diagonal block of node {} is not positive definite", node)};
}

bool invert_small(const double* block, Index stride, Index dim, double* inverse) {
  switch (dim) {
    case 0:
      return true;
    case 1:
      return invert_fixed<1>(block, stride, inverse);
    case 2:
      return invert_fixed<2>(block, stride, inverse);
    default:
      assert(dim == 3);
      return invert_fixed<3>(block, stride, inverse);
  }
}

Status DiagonalPreconditioner::update(const BlockCsr& a) {
  inverse_ = diagonal_of(a);
  for (std::size_t i = 0; i < inverse_.size(); ++i) {
    if (!(inverse_[i] > 0.0) || !std::isfinite(inverse_[i]))
      return bad_diagonal(static_cast<Index>(i), inverse_[i]);
    inverse_[i] = 1.0 / inverse_[i];
  }
  return {};
}

void DiagonalPreconditioner::apply(std::span<const double> r, std::span<double> z) const {
  assert(r.size() == inverse_.size() && z.size() == inverse_.size());
  multiply_each(inverse_, r, z);
}

Status BlockDiagonalPreconditioner::update(const BlockCsr& a) {
  pattern_ = a.pattern;
  const BlockPattern& p = *pattern_;
  inverse_.assign(9 * static_cast<std::size_t>(p.rows()), 0.0);
  for (Index i = 0; i < p.rows(); ++i)
    if (!invert_small(a.block(i, p.diagonal[i]), p.width(i), p.dim(i),
                      &inverse_[9 * static_cast<std::size_t>(i)]))
      return bad_diagonal_block(a, i);
  return {};
}

void BlockDiagonalPreconditioner::apply(std::span<const double> r, std::span<double> z) const {
  const BlockPattern& p = *pattern_;
  assert(static_cast<Index>(r.size()) == p.dofs() && r.size() == z.size());
  parallel_for(p.rows(), nodes_per_task, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index dof = p.dof_start[i], dim = p.dim(i);
      const double* inverse = &inverse_[9 * static_cast<std::size_t>(i)];
      if (dim == 3) {
        const double a = r[dof], b = r[dof + 1], c = r[dof + 2];
        z[dof] = inverse[0] * a + inverse[1] * b + inverse[2] * c;
        z[dof + 1] = inverse[3] * a + inverse[4] * b + inverse[5] * c;
        z[dof + 2] = inverse[6] * a + inverse[7] * b + inverse[8] * c;
      } else {
        for (Index row = 0; row < dim; ++row) {
          double s = 0.0;
          for (Index c = 0; c < dim; ++c) s += inverse[row * dim + c] * r[dof + c];
          z[dof + row] = s;
        }
      }
    }
  });
}

}  // namespace taut
