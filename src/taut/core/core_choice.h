#pragma once
// Which elements make the matrix core, chosen by strength (docs/mathematics.md, 5). A link is two
// nodes i, j with all springs between them; leaving it out adds its 3x3 block to D_R of both nodes.
// A larger element left out adds its diagonal blocks at all its nodes:
//
//   c_ij >= λmax of a link's block, c_ei >= that of an element's at node i: h² K + h D in any state
//   left out:  Σ c_ij + Σ c_ei <= target m_i at every node i, so ρ <= target
//
// The weakest, by c/m at the node where that is largest, are left out first, as long as all their
// nodes allow. With the target 8, cond(P⁻¹A) <= 9 q. The choice knows stiffness, damping, step size
// and masses only, not where the cloth is: it stays from step to step, and with it the factor's
// symbolic work. O(n log n) of links and elements, once per step size.

#include <cstdint>
#include <span>
#include <vector>

#include "taut/element/assembler.h"
#include "taut/linalg/block_csr.h"

namespace taut {

inline constexpr double core_target_rho = 8.0;

// bounds: c_ij for each block of the pattern (Assembler::block_bounds), symmetric; masses: kg, one
// a node; larger: Assembler::larger_elements. Returns one byte a block, 1: in the core. The
// diagonal always is, and all blocks of the larger elements that are not left out.
std::vector<std::uint8_t> choose_core(const BlockPattern& pattern, std::span<const double> bounds,
                                      std::span<const double> masses,
                                      double target_rho = core_target_rho,
                                      std::span<const LargerElement> larger = {});

// σ = max_i (Σ_j c_ij + Σ_e c_ei) / m_i: what the elements can add to a node's diagonal block,
// relative to its mass.
double stiffness_ratio(const BlockPattern& pattern, std::span<const double> bounds,
                       std::span<const double> masses, std::span<const LargerElement> larger = {});

}  // namespace taut
