#pragma once
// Names of the integrators; step/integrator.h has the formulas.

namespace taut {

enum class IntegratorKind { semi_implicit_euler, imex, bdf2 };

}  // namespace taut
