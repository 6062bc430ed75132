#pragma once
// Options of a linear solver; ranges in sim/describe_stepping.cpp.

#include <string>

namespace taut {

struct SolverOptions {
  // METHOD or METHOD:VARIANT ("core_pcg", "mpcg:diagonal", ...), one of solver_names().
  std::string name = "core_pcg";
  // Ascher & Boxerman's stop test: δ <= tolerance² δ0, δ = rᵀ M_p⁻¹ r, δ0 = b̂ᵀ M_p⁻¹ b̂.
  double tolerance = 1e-3;
  // Which springs make the matrix core: "stretch", the paper's; "auto", chosen by strength
  // (core/core_choice.h); empty: auto for solvers that say so (SolverTraits::chooses_core: the
  // solver `auto`), stretch for all others.
  std::string core = {};
  // 0: ten times the number of unknowns, at least 1000.
  int max_iterations = 0;
  // core_pcg: reorder `matrix` and vectors once before the loop (paper, Section 6, lines 6 and 7),
  // or the `vectors` in each iteration.
  std::string reordering = "vectors";
  // Direct factorisations: keep the ordering and symbolic work while the pattern is the same. The
  // paper (and the benches) analyse in every step.
  bool reuse_analysis = true;
  // SSOR's relaxation factor, above 0 and below 2; 1 is symmetric Gauss-Seidel.
  double ssor_omega = 1.0;
  bool chooses_core() const;
  bool operator==(const SolverOptions&) const = default;
};

}  // namespace taut
