#pragma once
// How many iterations corePCG can need at most (docs/mathematics.md, 5, not in the paper):
//
//   ρ = max_i λmax(D_R,i)/m_i over the springs outside the core       cond(P⁻¹A) <= κ = 2 (1 + ρ)
//   (1 + 2 ρ for core_fast, which takes these springs out of P; the same bound is used. Where it
//   replaces some of them by parallelograms, κ = (1 + 4 ρ_replaced) (1 + 2 ρ_dropped), see
//   BlockRemainder::ratios)
//   under the stop rule δ <= tol² δ0, from sqrt(δ_start/δ0) = start:   ceil(½ sqrt(κ) ln(2 sqrt(κ)
//   start / tol))
//
// It holds in exact arithmetic for elements of two nodes.

#include <cstdint>
#include <span>
#include <vector>

#include "taut/linalg/block_csr.h"

namespace taut {

// ρ of a cloth matrix of 3x3 blocks and its core (one byte a block, 1: in the core); masses: kg,
// one a node. Every element's block rows sum to zero, so D_R,i = -Σ A_ij over the blocks outside
// the core, whatever the elements. Rounded upwards. -1, not known, where a block outside the core
// is not symmetric: no element of two nodes makes such a one.
double remainder_ratio(const BlockCsr& a, std::span<const std::uint8_t> core,
                       std::span<const double> masses);
// Of several cores: A is read once.
std::vector<double> remainder_ratios(const BlockCsr& a,
                                     std::span<const std::span<const std::uint8_t>> cores,
                                     std::span<const double> masses);

// The same for an empty core, whose P is A's block diagonal: 2 max_i tr(A_ii)/tr(Σ_j A_ij) >=
// cond(P⁻¹A), since a row of a cloth matrix sums to mass and external damping, which are the same
// in all directions. Infinity where a row sums to nothing: not a cloth.
double block_diagonal_condition(const BlockCsr& a);

int core_iteration_bound(double rho, double start_value, double tolerance);
// The same for any κ.
int iteration_bound(double condition, double start_value, double tolerance);

}  // namespace taut
