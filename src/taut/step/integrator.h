#pragma once
// Time integration: what linear system a step solves, and what its solution means
// (docs/mathematics.md, 1; docs/design/integrators.md has the systems; paper Eq. 1, 2).
//
//   semi_implicit_euler   one linearisation of implicit Euler            Baraff & Witkin 1998
//   imex                  the same with K and D of stretch springs only  Ascher et al. 1997
//   imex_adaptive         with K and D of all springs but those that an
//                         explicit step takes stably                     Boxerman & Ascher 2004
//   bdf2                  second order, one linearised solve             Choi & Ko 2002
//   newton                implicit Euler, linearised until it holds      Hauth 2004
//
// The unknown is a velocity change dv (m/s) or a displacement dx (m). External damping (drag, wind)
// is always implicit: it is diagonal and costs nothing. BDF2's first step, and the step after a
// contact correction (State::has_previous is false), is one of semi-implicit Euler, whose dv then
// stands for the unknown.

#include <memory>
#include <string>

#include "taut/constraint/constraint_set.h"
#include "taut/element/assembler.h"
#include "taut/element/external.h"
#include "taut/step/integrator_options.h"
#include "taut/step/state.h"

namespace taut {

const char* name_of(IntegratorKind kind);

class Integrator {
 public:
  virtual ~Integrator() = default;
  // Whether these forces enter the matrix.
  virtual bool is_implicit(const ForceModel& model) const = 0;
  // "dv" or "dx" for this state.
  virtual std::string unknown(const State& state) const = 0;
  // A and b of a step of length h (s) from `state`. `external` has been evaluated for it.
  virtual void assemble(Assembler& assembler, const ExternalForces& external, const State& state,
                        double h, BlockCsr& a, std::span<Vec3> b) const = 0;
  // For integrators whose equations are nonlinear: A and b linearised about the end state (x_end,
  // v_end) that `unknown` gives, so that b - A unknown is the residual r there. `external` has been
  // evaluated for that state. False: the equations are linear, and nothing is done.
  virtual bool relinearise(Assembler& assembler, const ExternalForces& external, double h,
                           std::span<const Vec3> unknown, std::span<const Vec3> x_end,
                           std::span<const Vec3> v_end, BlockCsr& a, std::span<Vec3> b) const;
  virtual bool is_nonlinear() const { return false; }
  // The prescribed part z of the unknown from the constraints' displacements; zero at free nodes.
  virtual void prescribe(const ConstraintSet& constraints, const State& state, double h,
                         std::span<Vec3> z) const = 0;
  // Positions and velocities at the end of the step.
  virtual void finish(const State& state, double h, std::span<const Vec3> unknown,
                      std::span<Vec3> x_end, std::span<Vec3> v_end) const = 0;
  // One N s of impulse on a node, spread over the step, adds this much to b; and (A u - b) divided
  // by it is an impulse: h times the mean force.
  virtual double rhs_per_impulse(const State& state, double h) const = 0;
  // A's coefficients of D and K, for dumps and the core's bound.
  virtual double damping_coefficient(const State& state, double h) const = 0;
  virtual double stiffness_coefficient(const State& state, double h) const = 0;
};

std::unique_ptr<Integrator> make_integrator(IntegratorKind kind);

}  // namespace taut
