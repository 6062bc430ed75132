#include "taut/constraint/reduction.h"

#include <algorithm>
#include <cassert>

#include "taut/base/parallel.h"

namespace taut {

namespace {

constexpr Index nodes_per_task = 256;

using ConstMap3 = Eigen::Map<const Vec3>;
using Map3 = Eigen::Map<Vec3>;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// out (rows x cols, row-major with `stride`) = U_iᵀ B U_j, B 3x3 row-major with `width`.
void project_block(const double* b, Index width, const Mat3& ui, Index rows, const Mat3& uj,
                   Index cols, double* out, Index stride) {
  const Eigen::Map<const RowMajor3, 0, Eigen::OuterStride<>> block(b, Eigen::OuterStride<>(width));
  const Mat3 left = rows == 3 ? Mat3(block) : Mat3(ui.transpose() * block);
  const Mat3 both = cols == 3 ? left : Mat3(left * uj);
  for (Index r = 0; r < rows; ++r)
    for (Index c = 0; c < cols; ++c) out[r * stride + c] = both(r, c);
}

}  // namespace

bool Reduction::pattern_is_current(const BlockCsr& a, const ConstraintSet* constraints,
                                   std::span<const std::uint8_t> mask) const {
  if (!reduced_.pattern || source_pattern_ != a.pattern) return false;
  if (constraints ? !std::ranges::equal(constraints->ndofs(), ndof_) : !ndof_.empty()) return false;
  return std::ranges::equal(mask, mask_);
}

void Reduction::build_pattern(const BlockCsr& a, const ConstraintSet* constraints,
                              std::span<const std::uint8_t> mask) {
  const BlockPattern& p = *a.pattern;
  const Index n = p.rows();
  assert(!constraints || (constraints->nodes() == n && p.uniform_dim == 3));
  source_pattern_ = a.pattern;
  mask_.assign(mask.begin(), mask.end());
  ndof_.clear();
  if (constraints) ndof_.assign(constraints->ndofs().begin(), constraints->ndofs().end());

  // Nodes without freedom keep an empty row: node numbers stay the same everywhere.
  std::vector<Index> dof_start(static_cast<std::size_t>(n) + 1, 0),
      row_start(static_cast<std::size_t>(n) + 1, 0), column;
  for (Index i = 0; i < n; ++i)
    dof_start[i + 1] = dof_start[i] + (constraints ? constraints->ndof(i) : p.dim(i));
  const auto dim = [&](Index i) { return dof_start[i + 1] - dof_start[i]; };
  column.reserve(static_cast<std::size_t>(p.blocks()));
  source_block_.clear();
  for (Index i = 0; i < n; ++i) {
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
      const Index j = p.column[k];
      if (j != i && (dim(i) == 0 || dim(j) == 0 || (!mask.empty() && !mask[k]))) continue;
      column.push_back(j);
      source_block_.push_back(k);
    }
    row_start[i + 1] = static_cast<Index>(column.size());
  }
  reduced_ = BlockCsr(make_pattern(std::move(row_start), std::move(column), std::move(dof_start)));
}

bool Reduction::update(const BlockCsr& a, const ConstraintSet* constraints,
                       std::span<const std::uint8_t> mask) {
  const bool fresh = !pattern_is_current(a, constraints, mask);
  if (fresh) build_pattern(a, constraints, mask);
  const BlockPattern& from = *a.pattern;
  const BlockPattern& to = *reduced_.pattern;
  parallel_for(to.rows(), nodes_per_task, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index rows = to.dim(i), stride = to.width(i), width = from.width(i);
      for (Index k = to.row_start[i]; k < to.row_start[i + 1] && rows > 0; ++k) {
        const Index j = to.column[k], cols = to.dim(j);
        const double* block = a.block(i, source_block_[k]);
        double* out = reduced_.block(i, k);
        if (constraints && (rows < 3 || cols < 3)) {
          project_block(block, width, constraints->frame(i), rows, constraints->frame(j), cols, out,
                        stride);
        } else {
          for (Index r = 0; r < rows; ++r)
            std::copy(block + r * width, block + r * width + cols, out + r * stride);
        }
      }
    }
  });
  return fresh;
}

void restrict_to_free(const ConstraintSet* constraints, std::span<const double> full,
                      std::span<double> reduced) {
  if (!constraints) {
    std::copy(full.begin(), full.end(), reduced.begin());
    return;
  }
  Index out = 0;
  for (Index i = 0; i < constraints->nodes(); ++i) {
    const int ndof = constraints->ndof(i);
    const ConstMap3 v(&full[3 * static_cast<std::size_t>(i)]);
    if (ndof == 3) {
      Map3{&reduced[out]} = v;
    } else {
      for (int c = 0; c < ndof; ++c) reduced[out + c] = constraints->frame(i).col(c).dot(v);
    }
    out += ndof;
  }
  assert(out == static_cast<Index>(reduced.size()));
}

void prolong(const ConstraintSet* constraints, std::span<const double> reduced,
             std::span<const double> z, std::span<double> full) {
  if (!constraints) {
    std::copy(reduced.begin(), reduced.end(), full.begin());
    return;
  }
  Index in = 0;
  for (Index i = 0; i < constraints->nodes(); ++i) {
    const int ndof = constraints->ndof(i);
    Map3 v(&full[3 * static_cast<std::size_t>(i)]);
    if (ndof == 3) {
      v = ConstMap3(&reduced[in]);
    } else {
      Vec3 sum = constraints->constrained_part(i, ConstMap3(&z[3 * static_cast<std::size_t>(i)]));
      for (int c = 0; c < ndof; ++c) sum += reduced[in + c] * constraints->frame(i).col(c);
      v = sum;
    }
    in += ndof;
  }
}

void project_free(const ConstraintSet* constraints, std::span<double> v) {
  if (!constraints) return;
  for (Index i = 0; i < constraints->nodes(); ++i) {
    if (constraints->ndof(i) == 3) continue;
    Map3 node(&v[3 * static_cast<std::size_t>(i)]);
    node = constraints->free_part(i, node);
  }
}

void project_constrained(const ConstraintSet* constraints, std::span<double> v) {
  if (!constraints) {
    std::fill(v.begin(), v.end(), 0.0);
    return;
  }
  for (Index i = 0; i < constraints->nodes(); ++i) {
    Map3 node(&v[3 * static_cast<std::size_t>(i)]);
    node = constraints->constrained_part(i, node);
  }
}

}  // namespace taut
