#pragma once
// BDF2 with one linearised solve (Choi & Ko 2002). Formulas: integrator.h. Of order 2 on undamped,
// extended springs; the Jacobian terms dropped in compression cost order elsewhere
// (docs/mathematics.md, 1 and 2).

#include "taut/step/euler.h"

namespace taut {

class Bdf2 : public Integrator {
 public:
  bool is_implicit(const ForceModel&) const override { return true; }
  std::string unknown(const State& state) const override {
    return state.has_previous ? "dx" : "dv";
  }
  void assemble(Assembler& assembler, const ExternalForces& external, const State& state, double h,
                BlockCsr& a, std::span<Vec3> b) const override;
  // z = (I-S) d: a prescribed velocity v* of the formula's (2h v* + δ)/3 is that of a displacement
  // d, v* = (3d - δ)/(2h).
  void prescribe(const ConstraintSet& constraints, const State& state, double h,
                 std::span<Vec3> z) const override;
  void finish(const State& state, double h, std::span<const Vec3> dx, std::span<Vec3> x_end,
              std::span<Vec3> v_end) const override;
  // A force F over the step has the impulse h F and adds 4h²/9 F to b.
  double rhs_per_impulse(const State& state, double h) const override {
    return state.has_previous ? 4.0 * h / 9.0 : 1.0;
  }
  double damping_coefficient(const State& state, double h) const override {
    return state.has_previous ? 2.0 * h / 3.0 : h;
  }
  double stiffness_coefficient(const State& state, double h) const override {
    return state.has_previous ? 4.0 * h * h / 9.0 : h * h;
  }

 private:
  SemiImplicitEuler first_step_;
};

}  // namespace taut
