#pragma once
// The numbers of a block Cholesky factorisation in one precision: P A Pᵀ = L Lᵀ by the multifrontal method (Duff & Reid 1983; Liu 1992),
// and the solves.
//
// For each front, children first (front_kernels.h has the arithmetic, factor_layout.h the memory):
//
//   1  panel = 0; add the blocks of A in the pivots' columns; unknowns that are missing in A (and padding) get the identity
//   2  add the columns of the children's updates that are pivots here
//   3  eliminate the pivots
//   4  update = -L21 L21ᵀ, written, not accumulated: so it is never zeroed ...
//   5  ... and only then add the rest of the children's updates
//
// The solves keep one short vector a front, rows() long: forward, a front adds its children's and hands on what its pivots subtract from
// the rows below; backward, it reads the solution of those rows from its parent's. No two fronts that run at the same time write the same
// vector.

#include <span>

#include "taut/base/status.h"
#include "taut/linalg/block_cholesky/aligned_array.h"
#include "taut/linalg/block_cholesky/factor_layout.h"

namespace taut {

template <class T>
class NumericFactor {
 public:
  NumericFactor(const SupernodeTree& tree, const AnalyzedGraph& graph);

  // The pattern of A has been checked against the analysis. Allocates when the number of threads has changed, else nothing.
  Status factorize(const BlockCsr& a);
  // x = A⁻¹ b in double vectors of any numbering: the unknowns of the node at place k of the order begin at start[k] and are node_dim(k).
  void solve(std::span<const Index> start, std::span<const double> b, std::span<double> x);

  const FactorLayout& layout() const { return layout_; }
  const char* instruction_set() const { return kernels_.instruction_set; }
  Offset panel_bytes() const { return panels_.bytes(); }
  Offset bytes() const { return panels_.bytes() + updates_.bytes() + vectors_.bytes() + layout_.bytes(); }

 private:
  enum class Fate : std::uint8_t { eliminated, bad_pivot, skipped };

  void plan();
  void eliminate(const BlockCsr& a, Index s, bool shared);
  void assemble(const BlockCsr& a, const Front& front, T* panel) const;
  void add_children(const Front& front, T* target, bool target_is_panel);
  BadPivot factor_panel(const Front& front, T* panel, bool shared) const;
  Status verdict(const BlockCsr& a) const;
  void forward(const Front& front, std::span<const Index> start, const double* b);
  void backward(const Front& front, std::span<const Index> start, double* x);

  const FrontKernels<T>& kernels_;
  FactorLayout layout_;
  int planned_threads_ = 0;
  AlignedArray<T> panels_, updates_, vectors_;
  std::vector<Fate> fate_;           // per front
  std::vector<BadPivot> bad_pivot_;  // per front
  std::vector<Index> dim_;           // per place in the order: unknowns of the node in the factorised matrix
};

}  // namespace taut
