#pragma once
// How many iterations corePCG can need at most (docs/mathematics.md, 5, not in the paper):
//
//   ρ = max_i λmax(D_R,i)/m_i, D_R: the block diagonal of what the elements outside the core add
//   cond(P⁻¹A) <= κ     core/core.h has κ; 2 (1 + ρ) for elements of two nodes
//   under the stop rule δ <= tol² δ0, from sqrt(δ_start/δ0) = start:
//   ceil(½ sqrt(κ) ln(2 sqrt(κ) start/tol))
//
// core_fast, which takes the rest out of P, is within the same bound. Where it replaces springs by
// parallelograms, κ = (1 + 4 ρ_replaced) (1 + 2 ρ_dropped), see BlockRemainder::ratios. It holds in
// exact arithmetic.

#include <cstdint>
#include <span>
#include <vector>

#include "taut/linalg/block_csr.h"

namespace taut {

// ρ of a cloth matrix of 3x3 blocks and its core (one byte a block, 1: in the core), where only
// elements of two nodes are outside: which the caller knows. Then D_R,i = -Σ A_ij over the blocks
// outside. masses: kg, one a node. Rounded upwards. -1, not known, where such a block is not
// symmetric.
double remainder_ratio(const BlockCsr& a, std::span<const std::uint8_t> core,
                       std::span<const double> masses);
// The same from D_R itself, one block a node, whatever the elements.
double remainder_ratio(std::span<const Mat3> rest_diagonal, std::span<const double> masses);
// Of several cores: A is read once.
std::vector<double> remainder_ratios(const BlockCsr& a,
                                     std::span<const std::span<const std::uint8_t>> cores,
                                     std::span<const double> masses);

// Whether the blocks outside the core may be springs': symmetric and negative semidefinite, but for
// rounding. For matrices that come without their elements; those of bending over hinges are not.
bool may_be_springs(const BlockCsr& a, std::span<const std::uint8_t> core);

// The same as κ for an empty core, whose P is A's block diagonal: 2 max_i tr(A_ii)/tr(Σ_j A_ij) >=
// cond(P⁻¹A), since a row of a cloth matrix sums to mass and external damping, which are the same
// in all directions. Infinity where a row sums to nothing: not a cloth.
double block_diagonal_condition(const BlockCsr& a);

int core_iteration_bound(double rho, double start_value, double tolerance);
// The same for any κ.
int iteration_bound(double condition, double start_value, double tolerance);

}  // namespace taut
