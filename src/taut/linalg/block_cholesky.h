#pragma once
// Taut's own sparse Cholesky factorisation P A Pᵀ = L Lᵀ for matrices made of small blocks, one per
// node (cloth: 3x3; scalar matrices: 1x1).
//
//   analyze     nodes of few neighbours that share no block, to be eliminated first and by
//               themselves (block_cholesky/condensation.h); of the others' graph nested dissection,
//               elimination tree, supernodes; all memory planned: once per topology
//   factorize   multifrontal, dense SIMD kernels chosen for the machine, parallel over the tree and
//               inside its upper fronts
//   solve       forward and backward, double vectors in and out whatever the precision of L; x =
//               A⁻¹ b up to that precision
//
// Constraints come and go, the analysis stays: after analyze(pattern), factorize(A) takes any
// matrix whose nodes are those of the pattern with the same or fewer unknowns each (3, 2, 1 or 0)
// and whose blocks are among the pattern's; blocks may be missing. Missing unknowns are eliminated
// as the identity, so the cost is that of the full pattern. b and x are numbered as the unknowns of
// that A.
//
// Without copies: factorize(A, basis) takes the analysed blocks of Qᵀ A Q (linalg/node_basis.h)
// straight from A, and
//
//   solve_forward    y = L⁻¹ P Qᵀ b; returns yᵀy, which is rᵀ M⁻¹ r of conjugate gradients
//                    preconditioned by that part, for r = b
//   solve_backward   x = beta x + Q Pᵀ L⁻ᵀ y
//
// have A's unknowns on both sides. With a mask in analyze, those blocks are a part of A (the matrix
// core): A itself is never taken apart. The order is that part's own. Blocks outside it that have a
// place in its factor anyway, by fill-in, can be taken in for nothing. The first forward solve
// costs next to nothing when factorize does it on the way.
//
// Precision: `single` halves the memory that the solves read and doubles the speed of the
// arithmetic; meant for preconditioners. Subnormal numbers count as zero (base/flush_subnormals.h),
// so a matrix in single precision should not be smaller than 1e-30 throughout. `automatic` begins
// in single precision and factorises again in double precision when a pivot fails, which statistics
// count.
//
// Outcomes: not_positive_definite and not_finite name the first unknown, in the order of
// elimination, whose pivot is not a positive finite number, and its node. A pattern that does not
// fit the analysis: breakdown.
//
// Same bits for any number of threads. After the first of each, factorize and solve allocate
// nothing as long as pattern and number of threads stay.
//
// Sources: Liu 1992, SIAM Review 34 (multifrontal method); Davis 2006, Direct Methods for Sparse
// Linear Systems (trees, counts); Karypis & Kumar 1998 (METIS).

#include "taut/base/task_tree.h"
#include "taut/linalg/node_basis.h"
#include "taut/linalg/parallelogram.h"
#include "taut/linalg/sparse_cholesky.h"

namespace taut {

// Of the pattern's blocks that the mask leaves out: all of them, or only those without a place in
// the factor.
enum class BlocksLeftOut { all_outside_mask, without_place };

// What becomes of blocks of A that are not factorised.
struct BlocksOutside {
  // Each is added to the diagonal block of its row, so that block rows sum to what A's do: that
  // takes the springs out that made them, where else their part of the diagonal would stay. For
  // symmetric 3x3 blocks.
  bool lumped = false;
  // With lumped: those that BlockCholesky::parallelograms() has are replaced after that, by B =
  // -A_ac on the sides and -B on the other diagonal.
  bool replaced = false;
  RowsVisitor visit = {};  // sees all rows of A, once
  SideTasks beside = {};   // done during the factorisation, after that, where threads would be idle
};

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
