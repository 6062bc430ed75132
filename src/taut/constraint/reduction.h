#pragma once
// Elimination of the constrained unknowns (paper Section 3, Eq. 8, 9a-c, 11):
//
//   Ã = Uᵀ A U        b̃ = Uᵀ (b - A (I-S) z)        Ã ỹ = b̃        x = U ỹ + (I-S) z
//
//   A   3N x 3N, blocks of 3x3
//   U   3N x n, n = free_dofs()
//   Ã   n x n, blocks of ndof(i) x ndof(j): no new nonzeros
//
// The pattern of Ã is rebuilt only when some ndof (or the mask) changes. `mask` (one byte per block
// of A) keeps a subset of the blocks: that is how the matrix core is reduced (restriction to range
// U keeps every bound). The diagonal blocks must be in the mask. Without constraints (a null
// pointer) everything is a plain copy, and A's blocks may have any dims.

#include <cstdint>

#include "taut/constraint/constraint_set.h"
#include "taut/linalg/block_csr.h"

namespace taut {

class Reduction {
 public:
  // Recomputes Ã. `a` is not kept. True if the pattern of Ã is new.
  bool update(const BlockCsr& a, const ConstraintSet* constraints,
              std::span<const std::uint8_t> mask = {});
  const BlockCsr& matrix() const { return reduced_; }

 private:
  bool pattern_is_current(const BlockCsr& a, const ConstraintSet* constraints,
                          std::span<const std::uint8_t> mask) const;
  void build_pattern(const BlockCsr& a, const ConstraintSet* constraints,
                     std::span<const std::uint8_t> mask);

  BlockCsr reduced_;
  std::vector<Index> source_block_;  // for each block of Ã, the block of A it comes from
  std::shared_ptr<const BlockPattern> source_pattern_;
  std::vector<std::int8_t> ndof_;
  std::vector<std::uint8_t> mask_;
};

// reduced = Uᵀ full   (3N -> n). Without constraints: a copy.
void restrict_to_free(const ConstraintSet* constraints, std::span<const double> full,
                      std::span<double> reduced);
// full = U reduced + (I-S) z   (n -> 3N)
void prolong(const ConstraintSet* constraints, std::span<const double> reduced,
             std::span<const double> z, std::span<double> full);
// v := S v and v := (I-S) v in place; only constrained nodes are touched by the first.
void project_free(const ConstraintSet* constraints, std::span<double> v);
void project_constrained(const ConstraintSet* constraints, std::span<double> v);

}  // namespace taut
