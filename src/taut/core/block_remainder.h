#pragma once
// What a preconditioner made of some of a matrix's blocks leaves out, where it has the others
// lumped into its diagonal (BlocksOutside in linalg/block_cholesky.h): A = P + E,
//
//   (E c)_i = Σ_j A_ij (c_j - c_i)                   blocks outside a mask
//   (E c)_a = ... + Σ A_ac (c_a - c_b + c_c - c_d)   where parallelograms stand in for some
//
// and with it conjugate gradients' product without reading A, from the known p' = P c':
//
//   p = P c = r + β p'      q = A c = p + E c      cᵀq      (docs/mathematics.md, 5, "The product")
//
// For springs: 3x3 blocks, each symmetric, kept once in single precision and multiplied once for
// all its nodes. With constraints (linalg/node_basis.h), p and q hold something in constrained
// directions that nobody reads.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "taut/linalg/block_csr.h"
#include "taut/linalg/parallelogram.h"

namespace taut {

class BlockRemainder {
 public:
  // mask: one byte per block, 0 for those of E; not of 3x3 blocks: asserted. replaceable: what may
  // stand in for some of them. Allocates; the rest does not.
  void analyze(std::shared_ptr<const BlockPattern> pattern, std::span<const std::uint8_t> mask,
               std::span<const Parallelogram> replaceable = {});
  // Takes the values of E from a matrix of that pattern (asserted).
  void update(const BlockCsr& a);
  // The same for its rows begin ... end-1; rows may be taken in any order and in parallel.
  void update_rows(const BlockCsr& a, Index begin, Index end);
  // Whether the parallelograms do stand in, from now on.
  void set_replaced(bool replaced) { replaced_ = replaced; }
  // p = r + beta p, q = p + E c; returns cᵀ q. Where beta is 0, p may hold anything. Same bits for
  // any number of threads.
  double advance(double beta, std::span<const double> r, std::span<const double> c,
                 std::span<double> p, std::span<double> q) const;
  // q -= E c
  void subtract(std::span<const double> c, std::span<double> q) const;
  // The largest sum of blocks B = -A_ij at a node, in the Frobenius norm, relative to its mass
  // (kg): of those that are left out for good, and of the parallelograms at whose corners it is.
  // Rounded upwards.
  struct Ratios {
    double dropped = 0.0, replaced = 0.0;
  };
  Ratios ratios(std::span<const double> masses) const;
  // The same in parts, which are independent of each other: the largest at the nodes of each of so
  // many batches.
  Index batches() const { return static_cast<Index>(batch_.size()); }
  Ratios ratios_in(Index batch, std::span<const double> masses) const;
  static Ratios largest(std::span<const Ratios> of_batches);
  Offset nonzeros() const { return Offset{18} * static_cast<Offset>(copy_.size()); }
  Offset bytes() const;

  // Which copy of a block, and the nodes it acts between.
  struct Spring {
    Index block, node[2];
  };
  // ... and the corners of the parallelogram, in turn.
  struct Cell {
    Index block, node[4];
  };
  // Of a list: first those whose nodes are all in the batch, then the others.
  struct Range {
    Index begin, split, end;
  };
  struct Batch {
    Index first_row, end_row;
    Range dropped, replaceable;  // springs
    Range cells;
    bool has_last_node;  // behind whose three numbers a vector may end
  };
  struct Pieces;  // what a batch's products read

 private:
  Pieces pieces(const Batch& batch) const;

  std::shared_ptr<const BlockPattern> pattern_;
  bool replaced_ = false;
  // per row: the blocks copied from it, those right of the diagonal ...
  std::vector<Index> copy_start_{0};
  std::vector<Index> copy_;  // ... and their first columns in the row's panel of A
  std::vector<Batch> batch_;
  std::vector<Spring> spring_;  // batch after batch, in the order of their blocks
  std::vector<Cell> cell_;
  LargeVector<float> values_;  // row-major blocks, and a few entries that are read too many
};

}  // namespace taut
