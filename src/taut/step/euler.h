#pragma once
// Semi-implicit Euler, (M + hD + h²K) dv = h (f - h K v), and IMEX, which differs only in which springs are implicit. Formulas: integrator.h.

#include "taut/step/integrator.h"

namespace taut {

class SemiImplicitEuler : public Integrator {
 public:
  bool is_implicit(ForceClass) const override { return true; }
  std::string unknown(const State&) const override { return "dv"; }
  void assemble(Assembler& assembler, const ExternalForces& external, const State& state, double h, BlockCsr& a, std::span<Vec3> b) const override;
  // z = (I-S)(d/h - v)
  void prescribe(const ConstraintSet& constraints, const State& state, double h, std::span<Vec3> z) const override;
  void finish(const State& state, double h, std::span<const Vec3> dv, std::span<Vec3> x_end, std::span<Vec3> v_end) const override;
  double rhs_per_impulse(const State&, double) const override { return 1.0; }
  double damping_coefficient(const State&, double h) const override { return h; }
  double stiffness_coefficient(const State&, double h) const override { return h * h; }
};

class Imex : public SemiImplicitEuler {
 public:
  bool is_implicit(ForceClass force_class) const override { return force_class == ForceClass::stretch; }
};

}  // namespace taut
