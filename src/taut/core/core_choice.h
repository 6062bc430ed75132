#pragma once
// Which springs make the matrix core, chosen by strength (docs/mathematics.md, 5). A link is a pair
// of nodes i, j that the matrix couples, with all springs between them; leaving it out of the core
// adds its 3x3 block to D_R of both nodes:
//
//   c_ij >= λmax of that block, h² k + h k_d of its springs in any state and direction
//   kg
//   left out:  sum over the links left out at i of c_ij <= target m_i at every node, so ρ = max_i
//              λmax(D_R,i)/m_i <= target
//
// The weakest links, by c_ij / min(m_i, m_j), are left out first, as long as both their nodes
// allow. With the target 8, cond(P⁻¹A) <= 18. The choice knows stiffness, damping, step size and
// masses only, not where the cloth is: it stays from step to step, and with it the factor's
// symbolic work. O(links log links), once per step size.
//
// Element models of more than two nodes: the diagonal block of an element is minus the sum of its
// row's other blocks, so ρ holds with c_ij the norm of the block (i, j); the bound on the
// eigenvalues is then that for q nodes (docs/mathematics.md, 5).

#include <cstdint>
#include <span>
#include <vector>

#include "taut/linalg/block_csr.h"

namespace taut {

inline constexpr double core_target_rho = 8.0;

// bounds: c_ij for each block of the pattern (Assembler::block_bounds), symmetric; masses: kg, one
// a node. Returns one byte a block, 1: in the core. The diagonal always is.
std::vector<std::uint8_t> choose_core(const BlockPattern& pattern, std::span<const double> bounds,
                                      std::span<const double> masses,
                                      double target_rho = core_target_rho);

// σ = max_i Σ_j c_ij / m_i: what the elements can add to a node's diagonal block, relative to its
// mass.
double stiffness_ratio(const BlockPattern& pattern, std::span<const double> bounds,
                       std::span<const double> masses);

}  // namespace taut
