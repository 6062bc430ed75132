#pragma once
// The nonlinear loop of an integrator whose forces act at the end of the step (inexact simplified
// Newton method; Hauth 2004, and Hauth, Etzmuss & Strasser 2003). The linear solver inside it is
// the step's own, at its own tolerance:
//
//   r(u) = b(u) - A(u) u   residual of the momentum equation at the iterate u, N s; implicit Euler:
//                          h f - M u plus given impulses
//   A(u) u' = b(u)         solved on the constraints, starting at u; simplified: A holds the used
//                          Jacobians (docs/mathematics.md, 2)
//   u + α (u' - u)         α = 1, 1/2, 1/4, ... until |S r| falls
//   stop                   |S r|_(M⁻¹) <= tolerance * scale,  |r|²_(M⁻¹) = sum |r_i|²/m_i
//   scale                  |S b| of the step's first linear system plus h |f_ext|: what drives the
//                          step, with a floor for cloth at rest
//
// Convergence is linear at worst: the dropped terms are those of compressed springs.

#include <functional>

#include "taut/constraint/constraint_set.h"
#include "taut/solve/linear_system.h"
#include "taut/step/integrator_options.h"

namespace taut {

// What the loop asks of a step.
struct NewtonProblem {
  // Linearises about u and returns |S r(u)|_(M⁻¹).
  std::function<double(std::span<const Vec3> u)> relinearise;
  // S r(u)·d of the last linearisation.
  std::function<double(std::span<const Vec3> d)> slope;
  // Solves the last linearisation, starting at u; overwrites u.
  std::function<SolveSummary(std::span<Vec3> u)> solve;
};

struct NewtonSummary {
  Status status;
  int iterations = 0;   // linear solves after the first
  int halvings = 0;     // of a step, in the line search
  double residual = 0;  // |S r| / scale
  SolveSummary linear;  // the last solve; iterations: the most of any; times: sums
};

// u: the solution of the step's first linear system; the result. `linear`: that solve.
NewtonSummary newton(const NewtonProblem& problem, const NewtonOptions& options, double scale,
                     const SolveSummary& linear, std::vector<Vec3>& u);

}  // namespace taut
