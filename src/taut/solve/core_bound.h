#pragma once
// How many iterations corePCG can need at most (MATH.md section 5, not in the paper):
//
//   ρ = max_i λmax(D_R,i)/m_i over the springs outside the core       cond(P⁻¹A) <= κ = 2 (1 + ρ)
//   under the stop rule δ <= tol² δ0, from sqrt(δ_start/δ0) = start:   ceil(½ sqrt(κ) ln(2 sqrt(κ) start / tol))
//
// It holds in exact arithmetic for elements of two nodes.

namespace taut {

int core_iteration_bound(double rho, double start_value, double tolerance);

}  // namespace taut
