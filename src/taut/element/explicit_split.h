#pragma once
// Which springs may be integrated explicitly (the adaptive IMEX of Boxerman & Ascher 2004; the
// paper's Section 5 treats all shear and bend springs so). Derivation, for v_{n+1} = v_n - h M⁻¹
// (K_I x_{n+1} + K_E x_n + D_E v_n), x_{n+1} = x_n + h v_{n+1}:
//
//   a mode with h²ω_E² = e, hδ_E = d and any implicit part is stable as long as   e + 2d < 4
//   springs obey [B -B; -B B] <= 2 diag(B, B), so  e + 2d <= 2 max_i Σ_s c_s/m_i,   c_s = h² k_s +
//   2 h d_s
//   hence, half of what that allows kept in hand because forces are not linear:      Σ_s c_s/m_i <=
//   1 over the explicit springs of node i
//
//   k_s  largest stiffness of the spring at any length, N/m      d_s  its damping, N s/m      m_i
//   mass of a node, kg      h  step, s
//
// Stretch springs are always implicit. Of the others those with c_s/m_i up to a threshold per node
// are explicit, the weakest first; springs that are alike stay together, so that a uniform cloth is
// not made uneven.

#include <memory>
#include <span>
#include <vector>

#include "taut/element/spring_model.h"

namespace taut {

// Replaces each model by those of its springs that must be implicit and, marked
// stable_explicitly(), those that need not; neither if empty.
std::vector<std::unique_ptr<SpringModel>> split_by_stability(
    std::vector<std::unique_ptr<SpringModel>> models, std::span<const double> masses, double h);

}  // namespace taut
