#pragma once
// The numbers of a block Cholesky factorisation in one precision: P A Pᵀ = L Lᵀ by the multifrontal
// method (Duff & Reid 1983; Liu 1992), and the solves. A's blocks are gathered in the order of
// elimination; condensed nodes are eliminated on the way. Then for each front, children first:
//
//   1   panel = 0, then A's blocks in the pivots' columns, less what condensed nodes leave;
//       unknowns that are missing in A, and padding, get the identity
//   2   add the columns of the children's updates that are pivots here
//   3   eliminate the pivots
//   4   update = -L21 L21ᵀ, written, not accumulated: so it is never zeroed
//   5   only then add the rest of the children's updates
//   6   pack the panel
//
// The solves keep one short vector a front; no two fronts that run at the same time write the same
// one. More: docs/design/block-cholesky.md.

#include <array>
#include <atomic>
#include <span>

#include "taut/base/status.h"
#include "taut/linalg/block_cholesky/aligned_array.h"
#include "taut/linalg/block_cholesky/factor_layout.h"
#include "taut/linalg/block_cholesky/replacement.h"
#include "taut/linalg/block_cholesky/runnable_kernels.h"
#include "taut/linalg/node_basis.h"

namespace taut {

// What is factorised: the analysed blocks of Qᵀ A Q.
struct FactorSource {
  const BlockCsr& a;
  NodeBasis basis;
  // A has the analysed pattern itself; else one that fits it, and blocks are searched
  bool pattern_is_analyzed;
  const UnanalyzedBlocks* lumped = nullptr;  // each is added to its row's diagonal block
  // of the analysed pattern, and always the same ones; besides lumped
  std::span<const Parallelogram> replaced = {};
  const RowsVisitor* visit = nullptr;
  const SideTasks* beside = nullptr;
};

// Right-hand sides and solutions: the node at place k of the order has its unknowns from start[k]
// on. With a basis these are all three; Q is applied on the way in and out.
struct FactorVectors {
  std::span<const Index> start;
  // multiplies what comes in and divides what goes out: keeps single precision in range
  double scale = 1.0;
};

// A right-hand side whose forward solve is done during the factorisation.
struct FactorLoad {
  const double* b = nullptr;
  double scale = 1.0;  // as in FactorVectors
};

template <class T>
class NumericFactor {
 public:
  NumericFactor(const SupernodeTree& tree, const CondensedGraph& graph,
                std::span<const Index> condensed_at,
                const FrontKernels<T>& kernels = front_kernels<T>());

  // The pattern of A has been checked against the analysis. Allocates when the number of threads
  // has changed or more nodes than ever have a basis of their own, or a second load comes for the
  // first time, else nothing. The forward solves of up to two loads are done on the way, while each
  // front is in the cache; the last one's y stays.
  Status factorize(const FactorSource& source, std::span<const Index> start,
                   std::span<const FactorLoad> loads);
  // y = L⁻¹ P Qᵀ b
  void solve_forward(const FactorVectors& vectors, const double* b);
  // x = beta x + Q Pᵀ L⁻ᵀ y, for the y of the last forward solve, which is lost.
  void solve_backward(const FactorVectors& vectors, double beta, double* x);
  // yᵀy of the last forward solve, with its scale: summed in a fixed order.
  double forward_norm2() const { return norm2_of(0); }
  // Of the first of two loads.
  double first_load_norm2() const { return norm2_of(1); }

  const FactorLayout& layout() const { return layout_; }
  const char* instruction_set() const { return kernels_.instruction_set; }
  // What a solve reads of the factor.
  Offset panel_bytes() const {
    return packed_.bytes() + layout_.block_start[layout_.condensed] * Offset{9 * sizeof(T)};
  }
  Offset bytes() const {
    return gathered_.bytes() + packed_.bytes() + arena_.bytes() + scratch_.bytes() +
           vectors_[0].bytes() + vectors_[1].bytes() + condensed_vectors_[0].bytes() +
           condensed_vectors_[1].bytes() + layout_.bytes() + replacement_.bytes();
  }

 private:
  static constexpr Offset read_too_many = 3;  // entries, behind a block's last column
  enum class Fate : std::uint8_t { eliminated, bad_pivot, skipped };

  double norm2_of(int slot) const;
  void plan();
  void take_dims(const FactorSource& source);
  void gather(const FactorSource& source);
  void gather_row(const FactorSource& source, Index k);
  void add_replaced(const FactorSource& source, Index row);
  // Condensed nodes: those of some of A's rows; one that is not plain.
  void mark_projected(Index k);
  void condense_rows(Index begin, Index end);
  BadPivot condense_projected(Index k);
  double forward_condensed(const Front& front, const FactorVectors& vectors, const double* b,
                           int slot);
  void backward_condensed(const Front& front, const FactorVectors& vectors, double beta,
                          double* x) const;
  void forward_projected(Index k, double scale, const double* b, T* own, T* y) const;
  Vec3 backward_projected(Index k, const T* own, const T* y) const;
  void turn_back(Index k, const T* solution, T (&to)[3]) const;
  // scratch: the thread's
  void eliminate(Index s, bool shared, T* scratch);
  void assemble(const Front& front, T* panel, bool shared) const;
  void assemble_projected(const Front& front, Index k, T* panel) const;
  T* update_of(const Front& front, T* scratch) {
    return (front.update_in_scratch ? scratch : arena_.data()) + front.update;
  }
  void add_children(const Front& front, T* scratch, T* target, bool target_is_panel, bool shared);
  BadPivot factor_panel(const Front& front, T* panel, bool shared) const;
  void form_update(const Front& front, T* scratch, const T* panel, bool shared);
  void pack(const Front& front, const T* panel, bool shared);
  Status verdict(const BlockCsr& a);
  Status failure(const BlockCsr& a, Index k, Index component, double pivot) const;
  // slot: of vectors_ and norm2_; 0 is the one that backward() takes.
  void forward(Index s, const FactorVectors& vectors, const double* b, int slot = 0);
  void backward(Index s, const FactorVectors& vectors, double beta, double* x);

  const FrontKernels<T>& kernels_;
  FactorLayout layout_;
  Replacement replacement_;  // planned when it is first asked for
  int planned_threads_ = 0;
  AlignedArray<T> gathered_, packed_, arena_, scratch_;
  Offset scratch_of_thread_ = 0;
  std::array<AlignedArray<T>, 2> vectors_;
  // y of the condensed nodes, three numbers each and one that is nobody's
  std::array<AlignedArray<T>, 2> condensed_vectors_;
  std::atomic<Index> first_bad_condensed_;  // place of the first condensed node whose pivot is bad
  std::vector<Fate> fate_;                  // per front
  std::vector<BadPivot> bad_pivot_;         // per front
  // per front: of its part of y, with its condensed nodes
  std::array<std::vector<double>, 2> norm2_;
  // per place in the order: unknowns of the node in the factorised matrix
  std::vector<Index> dim_;
  // per place: three unknowns, without a basis of their own
  std::vector<std::uint8_t> is_plain_;
  std::vector<std::uint8_t> is_plain_with_neighbours_;  // per condensed node
  std::vector<Index> not_plain_;                        // places, of the last matrix
  std::vector<Index> basis_of_;  // per place: its Q_i in basis_, or -1: the identity
  std::vector<Mat3> basis_;
};

}  // namespace taut
