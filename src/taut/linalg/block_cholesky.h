#pragma once
// Taut's own sparse Cholesky factorisation P A Pᵀ = L Lᵀ for matrices of small blocks, one per node
// (cloth: 3x3; scalar matrices: 1x1). How and why: docs/design/block-cholesky.md.
//
//   analyze          order, tree and memory, once per topology; with a mask, of part of the blocks
//   factorize        the numbers; multifrontal, SIMD kernels chosen for the machine, parallel
//   solve            x = A⁻¹ b: double vectors, up to the precision of L
//   solve_forward    y = L⁻¹ P Qᵀ b, returns yᵀy     Q: linalg/node_basis.h
//   solve_backward   x = beta x + Q Pᵀ L⁻ᵀ y
//
// After analyze(pattern), factorize(A) takes any A whose nodes have the same or fewer unknowns and
// whose blocks are among the pattern's. A bad pivot is not_positive_definite or not_finite and
// names its unknown and node; a pattern that does not fit the analysis is breakdown. In single
// precision subnormal numbers count as zero: A should not be smaller than 1e-30 throughout. Same
// bits for any number of threads; nothing is allocated after the first of each call.

#include "taut/base/task_tree.h"
#include "taut/linalg/node_basis.h"
#include "taut/linalg/parallelogram.h"
#include "taut/linalg/sparse_cholesky.h"

namespace taut {

// Of the pattern's blocks that the mask leaves out: all of them, or only those
// without a place in the factor.
enum class BlocksLeftOut { all_outside_mask, without_place };

// What becomes of blocks of A that are not factorised.
struct BlocksOutside {
  // Each is added to the diagonal block of its row, so that block rows sum to what A's do: that
  // takes the springs out that made them, where else their part of the diagonal would stay. For
  // symmetric 3x3 blocks.
  bool lumped = false;
  // With lumped: those that BlockCholesky::parallelograms() has are replaced after that, by
  // B = -A_ac on the sides and -B on the other diagonal.
  bool replaced = false;
  RowsVisitor visit = {};  // sees all rows of A, once
  SideTasks beside = {};   // done during the factorisation, after that, where threads would be idle
};

// `single_precision` halves the memory that the solves read and doubles the speed of the
// arithmetic; meant for preconditioners. `automatic` begins there and factorises again in double
// precision when a pivot fails, which statistics count.
enum class CholeskyPrecision { double_precision, single_precision, automatic };

struct BlockCholeskyStatistics {
  // nodes that are eliminated before all others, each by itself (block_cholesky/condensation.h)
  Index condensed = 0;
  Index supernodes = 0;         // of the others
  double factor_entries = 0.0;  // of L without padding and without what amalgamation adds
  double flops = 0.0;           // multiplications and additions for those entries
  double padded_flops = 0.0;    // what is really done
  double panel_bytes = 0.0;     // of L as stored: what each of the two solves reads
  double total_bytes = 0.0;     // with updates, vectors, index lists
  bool single_precision = false;
  int fallbacks = 0;            // factorisations repeated in double precision
  std::string instruction_set;  // of the kernels
};

class BlockCholesky : public SparseCholesky {
 public:
  explicit BlockCholesky(CholeskyPrecision precision = CholeskyPrecision::double_precision);
  ~BlockCholesky() override;

  std::string name() const override;  // "block", "block_single" or "block_automatic"
  // Of the next factorisations; the analysis stays.
  void set_precision(CholeskyPrecision precision);
  Status analyze(const BlockCsr& a) override;
  Status analyze(const BlockPattern& pattern);
  // Only blocks whose byte of the mask is not 0, and the diagonal ones; an empty mask: all.
  Status analyze(std::shared_ptr<const BlockPattern> pattern, std::span<const std::uint8_t> mask,
                 BlocksLeftOut left_out = BlocksLeftOut::all_outside_mask);
  // Of that analysis: one byte per block of the pattern, 1 for those that are factorised.
  std::span<const std::uint8_t> analyzed_blocks() const;
  // Of that analysis, of 3x3 blocks: what can stand in for blocks that are left out; sides are
  // blocks of the mask.
  std::span<const Parallelogram> parallelograms() const;
  Status factorize(const BlockCsr& a) override;
  // The analysed blocks of Qᵀ A Q; A must have the analysed pattern (asserted). `basis` is not
  // kept. b, if not empty: solve_forward(b) at once, whose result goes to *b_norm2.
  Status factorize(const BlockCsr& a, const NodeBasis& basis, std::span<const double> b = {},
                   double* b_norm2 = nullptr, const BlocksOutside& outside = {});
  // Also solve_forward(r), whose y is the one that stays; on the way, both cost next to nothing.
  Status factorize(const BlockCsr& a, const NodeBasis& basis, std::span<const double> b,
                   double& b_norm2, std::span<const double> r, double& r_norm2,
                   const BlocksOutside& outside = {});
  double solve_forward(std::span<const double> b);
  // For a caller who knows largest_magnitude(b).
  double solve_forward(std::span<const double> b, double largest);
  void solve_backward(double beta, std::span<double> x);
  Status solve(std::span<const double> b, std::span<double> x) override;
  // Of the matrix analysed, or of the matrix last factorised.
  std::span<const Index> permutation() const override;
  Status solve_permuted(std::span<const double> b, std::span<double> x) override;
  FactorStatistics statistics() const override;
  BlockCholeskyStatistics block_statistics() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace taut
