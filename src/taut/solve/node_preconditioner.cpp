#include "taut/solve/node_preconditioner.h"

#include "taut/base/parallel.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

Status ProjectedNodePreconditioner::update(const BlockCsr& a) {
  const BlockPattern& p = *a.pattern;
  // Checks the diagonal and reports the unknown; its blocks are projected below.
  DiagonalPreconditioner diagonal;
  if (Status status = diagonal.update(a); !status.ok()) return status;
  const std::vector<double> d = diagonal_of(a);

  Index dof = 0;
  nodes_.clear(), block_.clear(), scalar_.clear();
  for (Index i = 0; i < p.rows(); ++i) {
    const Index dim = constraints_ ? constraints_->ndof(i) : p.dim(i);
    const Index full = p.dim(i), first = p.dof_start[i];
    const bool all_free = dim == full;
    if (kind_ == NodeDiagonal::scalar && all_free) {
      for (Index r = 0; r < dim; ++r) scalar_.push_back(1.0 / d[first + r]);
    } else if (dim > 0) {
      double inverse[9] = {};
      if (kind_ == NodeDiagonal::scalar) {
        for (Index r = 0; r < full; ++r) inverse[4 * r] = 1.0 / d[first + r];
      } else if (!invert_small(a.block(i, p.diagonal[i]), p.width(i), full, inverse)) {
        return bad_diagonal_block(a, i);
      }
      nodes_.push_back({dof, dim, static_cast<Index>(block_.size())});
      if (all_free) {
        block_.insert(block_.end(), inverse, inverse + dim * dim);
      } else {
        const Mat3 m = Eigen::Map<const Mat3>(inverse);
        const Mat3& u = constraints_->frame(i);
        for (Index r = 0; r < dim; ++r)
          for (Index c = 0; c < dim; ++c) block_.push_back(u.col(r).dot(m * u.col(c)));
      }
      scalar_.insert(scalar_.end(), static_cast<std::size_t>(dim), 0.0);
    }
    dof += dim;
  }
  return {};
}

void ProjectedNodePreconditioner::apply(std::span<const double> r, std::span<double> z) const {
  if (kind_ == NodeDiagonal::scalar) multiply_each(scalar_, r, z);
  parallel_for(static_cast<Index>(nodes_.size()), 4096, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      const Node& node = nodes_[k];
      const double* b = &block_[node.block];
      const double* in = &r[node.dof];
      double* out = &z[node.dof];
      if (node.dim == 3) {
        out[0] = b[0] * in[0] + b[1] * in[1] + b[2] * in[2];
        out[1] = b[3] * in[0] + b[4] * in[1] + b[5] * in[2];
        out[2] = b[6] * in[0] + b[7] * in[1] + b[8] * in[2];
      } else {
        for (Index row = 0; row < node.dim; ++row) {
          out[row] = 0.0;
          for (Index c = 0; c < node.dim; ++c) out[row] += b[row * node.dim + c] * in[c];
        }
      }
    }
  });
}

}  // namespace taut
