#pragma once
// Which springs may be integrated explicitly (the adaptive IMEX of Boxerman & Ascher 2004; the
// paper's Section 5 treats all shear and bend springs so): those of a node with
//
//   Σ_s c_s/m_i <= 1,   c_s = h² k_s + 2 h d_s     half of what is stable
//
//   k_s   largest stiffness of the spring at any length, N/m
//   d_s   its damping, N s/m
//   m_i   mass of the node, kg
//   h     step, s
//
// Stretch springs are always implicit. Of the others those with c_s/m_i up to a threshold per node
// are explicit, the weakest first; springs that are alike stay together, so that a uniform cloth is
// not made uneven. Derivation: docs/design/integrators.md.

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
