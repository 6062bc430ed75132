#pragma once
// Semi-implicit Euler, IMEX, which differs only in which springs are implicit, and implicit Euler,
// which goes on from there. Formulas: step/integrator.h.
//
//   semi-implicit   (M + hD + h²K) dv = h (f - h K v)
//   implicit        M dv = h f with f at the end of the step, linearised again and again:
//                   (M + hD + h²K) dv' = h f + (hD + h²K) dv

#include "taut/step/integrator.h"

namespace taut {

class SemiImplicitEuler : public Integrator {
 public:
  bool is_implicit(const ForceModel&) const override { return true; }
  std::string unknown(const State&) const override { return "dv"; }
  void assemble(Assembler& assembler, const ExternalForces& external, const State& state, double h,
                BlockCsr& a, std::span<Vec3> b) const override;
  // z = (I-S)(d/h - v)
  void prescribe(const ConstraintSet& constraints, const State& state, double h,
                 std::span<Vec3> z) const override;
  void finish(const State& state, double h, std::span<const Vec3> dv, std::span<Vec3> x_end,
              std::span<Vec3> v_end) const override;
  double rhs_per_impulse(const State&, double) const override { return 1.0; }
  double damping_coefficient(const State&, double h) const override { return h; }
  double stiffness_coefficient(const State&, double h) const override { return h * h; }
};

class Imex : public SemiImplicitEuler {
 public:
  bool is_implicit(const ForceModel& model) const override {
    return model.force_class() == ForceClass::stretch;
  }
};

class AdaptiveImex : public SemiImplicitEuler {
 public:
  bool is_implicit(const ForceModel& model) const override { return !model.stable_explicitly(); }
};

class ImplicitEuler : public SemiImplicitEuler {
 public:
  bool is_nonlinear() const override { return true; }
  bool relinearise(Assembler& assembler, const ExternalForces& external, double h,
                   std::span<const Vec3> dv, std::span<const Vec3> x_end,
                   std::span<const Vec3> v_end, BlockCsr& a, std::span<Vec3> b) const override;
};

}  // namespace taut
