#pragma once
// A matrix core as a solver receives it: which blocks of A = M + L_C + L_R it has, and what it
// leaves out (docs/mathematics.md, 5). C: the elements whose blocks off the diagonal are all in the
// mask; R: the rest.
//
//   P = M + L_C         the core without the rest altogether
//   P = M + L_C + D_R   with its part of the diagonal (the paper's)
//   cond(P⁻¹A) <= 1 + q ρ <= q (1 + ρ) for both
//   ρ = max_i λmax(D_R,i)/m_i, D_R the block diagonal of L_R;    q: nodes of R's largest element
//
// Where R has two-node elements only, both are made of A's own blocks: those of the mask, for the
// first with each other block added to the diagonal block of its row. Larger elements have blocks
// inside the mask as well: then `matrix` is M + L_C, and `rest_diagonal` D_R.

#include <cstdint>
#include <span>
#include <string>

#include "taut/linalg/block_csr.h"

namespace taut {

struct Core {
  std::string name;  // of the families of elements in it: "stretch+shear"; "auto": by strength
  // one byte per block of A, 1: in the core; empty: only the diagonal blocks
  std::span<const std::uint8_t> mask = {};
  double rho = -1.0;        // negative: not known, and no bound
  Index nodes_outside = 2;  // q
  const BlockCsr* matrix = nullptr;
  std::span<const Mat3> rest_diagonal = {};

  // What cond(P⁻¹A) cannot exceed, of both; for two-node elements the weaker form. Negative: not
  // known.
  double condition() const {
    return rho < 0.0 ? -1.0 : nodes_outside == 2 ? 2.0 * (1.0 + rho) : 1.0 + nodes_outside * rho;
  }
};

}  // namespace taut
