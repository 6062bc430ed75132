#pragma once
// Sparse matrix made of small dense blocks, one block row per node. One type serves the full matrix
// (all blocks 3x3), the matrix reduced by constraints (blocks of 0 to 3 rows and columns) and
// anyone's scalar matrix (blocks 1x1). Both triangles are stored.
//
//   node i        has dim(i) unknowns, numbered dof_start[i] ... dof_start[i+1]-1
//   block row i   has the blocks k = row_start[i] ... row_start[i+1]-1 in columns column[k],
//                 ascending, the diagonal among them
//   values        of a row: one dense row-major panel of dim(i) rows and width(i) = sum of
//                 dim(column[k]) columns, from values[value_start[i]] on
//
//   A(i, column[k]) [r][c] = values[value_start[i] + r * width(i) + block_offset[k] + c]
//
// so a product needs one gather of x and dim(i) straight dot products per
// row, whatever the dims are.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "taut/base/huge_pages.h"
#include "taut/base/types.h"

namespace taut {

// Where the blocks are. Built once per topology (or per set of constraints) and shared by all
// matrices with that pattern.
struct BlockPattern {
  std::vector<Index> dof_start;     // rows + 1
  std::vector<Index> row_start;     // rows + 1, into column and block_offset
  std::vector<Index> column;        // block column of each block
  std::vector<Index> column_dof;    // dof_start[column] of each block: where its part of x begins
  std::vector<Index> block_offset;  // first column of each block in its row's panel
  std::vector<Index> diagonal;      // rows: which block is the diagonal one
  std::vector<Offset> value_start;  // rows + 1
  Index uniform_dim = 0;            // the common dim of all nodes, or 0 if they differ

  Index rows() const { return static_cast<Index>(row_start.size()) - 1; }
  Index dofs() const { return dof_start.back(); }
  Index blocks() const { return row_start.back(); }
  Offset value_count() const { return value_start.back(); }
  Index dim(Index i) const { return dof_start[i + 1] - dof_start[i]; }
  Index width(Index i) const {
    const Index d = dim(i);
    return d == 0 ? 0 : static_cast<Index>((value_start[i + 1] - value_start[i]) / d);
  }
  // The block at (i, j), or -1.
  Index find(Index i, Index j) const;
  Offset bytes() const;
};

// Pattern from lists of columns, sorted and unique; the diagonal is added where missing.
// dims[i]: unknowns of node i. Asserts that columns are in range.
std::shared_ptr<const BlockPattern> make_pattern(std::vector<std::vector<Index>> columns,
                                                 std::span<const Index> dims);
std::shared_ptr<const BlockPattern> make_pattern(std::vector<std::vector<Index>> columns,
                                                 Index uniform_dim);
// The same from compressed rows whose columns are already sorted and unique and hold the diagonal
// (fast path of the reduction).
std::shared_ptr<const BlockPattern> make_pattern(std::vector<Index> row_start,
                                                 std::vector<Index> column,
                                                 std::vector<Index> dof_start);

struct BlockCsr {
  std::shared_ptr<const BlockPattern> pattern;
  LargeVector<double> values;

  BlockCsr() = default;
  explicit BlockCsr(std::shared_ptr<const BlockPattern> p)
      : pattern(std::move(p)), values(static_cast<std::size_t>(pattern->value_count())) {}

  Index rows() const { return pattern->rows(); }
  Index dofs() const { return pattern->dofs(); }
  double* block(Index i, Index k) {
    return values.data() + pattern->value_start[i] + pattern->block_offset[k];
  }
  const double* block(Index i, Index k) const {
    return values.data() + pattern->value_start[i] + pattern->block_offset[k];
  }
  // One scalar entry, 0 where no block is. For tests and messages: it searches.
  double at(Index row_dof, Index column_dof) const;
  Offset bytes() const {
    return static_cast<Offset>(values.size() * sizeof(double)) + pattern->bytes();
  }
};

// Called for all rows of a matrix, begin ... end-1 at a time, in parallel, by a pass that reads
// them, while they are in the cache.
using RowsVisitor = std::function<void(Index begin, Index end)>;

// y = A x (x, y: dofs() doubles, not overlapping). Parallel over block rows, same bits for any
// thread count, no allocation.
void multiply(const BlockCsr& a, std::span<const double> x, std::span<double> y);
// The same, and returns xᵀ A x.
double multiply_dot(const BlockCsr& a, std::span<const double> x, std::span<double> y);
// Bytes that one product must read and write at least: values, indices, x, y.
Offset multiply_bytes(const BlockCsr& a);

// Scalar diagonal of A, dofs() entries.
std::vector<double> diagonal_of(const BlockCsr& a);

}  // namespace taut
