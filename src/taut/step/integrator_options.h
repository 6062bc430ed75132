#pragma once
// Names of the integrators and the options of those that have any;
// step/integrator.h has the formulas.

namespace taut {

enum class IntegratorKind { semi_implicit_euler, imex, imex_adaptive, bdf2, newton };

// Newton's method stops at |S r|_(M⁻¹) <= tolerance * scale (step/newton.h).
struct NewtonOptions {
  double tolerance = 1e-3;
  int max_iterations = 30;  // linearisations a solve
  bool operator==(const NewtonOptions&) const = default;
};

}  // namespace taut
