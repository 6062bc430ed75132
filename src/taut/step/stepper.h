#pragma once
// One step: assemble -> constrain -> solve -> update. Contact may ask for several solves of the
// same assembled system with other constraints and impulses (passes); the loop in sim/simulation.h
// joins the two.
//
//   begin(state, h)               A and b, once
//   solve(constraints, impulses)  the unknown, the end positions and velocities, the constraint
//                                 impulses; may be repeated. One linear solve, or with a nonlinear
//                                 integrator as many as Newton's method takes
//   commit(state)                 takes the last solve's end state over
//   correct(state, x, h)          takes positions over that contact has corrected since
//
// Constraint impulse (N s, on each node): j = (I - S)(A u - b), scaled to an impulse
// (docs/mathematics.md, 3.6). A positive n·j pushes along n.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "taut/core/element_core.h"
#include "taut/solve/solver.h"
#include "taut/step/integrator.h"

namespace taut {

class Stepper {
 public:
  // models: not owned. Whether the core is the stretch springs or chosen is the solver's option.
  Stepper(Index nodes, std::vector<const ForceModel*> models, ExternalForces external,
          IntegratorKind integrator, SolverOptions solver, NewtonOptions newton = {});

  // Chooses the core for steps of up to h (s), whose coefficients are the largest: it then stays
  // the same, and valid, in shorter steps. Not called: begin() does it with the longest h so far.
  void choose_core(double h);
  void begin(const State& state, double h);
  SolveSummary solve(const ConstraintSet& constraints, std::span<const Vec3> impulses) {
    return solve(constraints, impulses, *solver_);
  }
  // The same with another solver than the step's own.
  SolveSummary solve(const ConstraintSet& constraints, std::span<const Vec3> impulses,
                     ConstrainedSolver& solver);
  std::span<const Vec3> x_end() const { return x_end_; }
  std::span<const Vec3> v_end() const { return v_end_; }
  std::span<const Vec3> constraint_impulse() const { return impulse_; }

  // Ends the step: state becomes (x_end, v_end) at time + h.
  void commit(State& state);
  // After that: `corrected` positions replace the state's, the velocity is changed by what they
  // moved over h (s), and a multistep method starts afresh.
  void correct(State& state, std::span<const Vec3> corrected, double h) const;
  double h() const { return h_; }
  // The next step is of another size than the last: a multistep method must
  // not use the step before.
  void start_afresh(State& state) const;

  // The system of the last begin/solve, for dumps, benches and other solvers; of several
  // linearisations the last. Valid until the next call.
  LinearSystem system() const;
  const BlockCsr& matrix() const { return *current_a_; }
  // Linear solves of the last solve() after its first; 0 unless the integrator is nonlinear.
  int newton_iterations() const { return newton_iterations_; }
  std::span<const std::uint8_t> core_mask() const { return cores_[0].mask(); }
  // Elements of the core of that name (SolveSummary::core); empty: of the step's own.
  Index core_springs(std::string_view name = {}) const;
  std::span<const Vec3> unknown() const { return unknown_; }
  // The impulses that the last solve was given, N s; empty if none.
  std::span<const Vec3> impulses() const { return given_; }
  const Integrator& integrator() const { return *integrator_; }
  const ExternalForces& external() const { return external_; }
  // Air, gravity and applied forces of the steps to come.
  ExternalForces& external() { return external_; }
  Assembler& assembler() { return assembler_; }
  ConstrainedSolver& solver() { return *solver_; }
  const ConstrainedSolver& solver() const { return *solver_; }
  double assemble_ms() const { return assemble_ms_; }
  // ρ of docs/mathematics.md, 5 for the assembled system and its core.
  double remainder_ratio() const;
  // Masks of cores that a solver may be given: all elements of these families, or those that are
  // strong in steps of up to h (core/core_choice.h).
  std::vector<std::uint8_t> family_core(std::span<const ForceClass> families) const;
  std::vector<std::uint8_t> chosen_core(double h) const;

 private:
  SolveSummary solve_nonlinear(const ConstraintSet& constraints, ConstrainedSolver& solver,
                               SolveSummary first);
  double relinearise(const ConstraintSet& constraints, std::span<const Vec3> unknown);
  double free_norm(const ConstraintSet& constraints, std::span<const Vec3> momentum) const;
  void measure_cores(std::vector<CoreRest>& rests);
  std::vector<double> block_bounds(double h) const;
  std::vector<LargerElement> larger_elements(double h) const;
  void forget_other_unknown(State& state, const std::string& solved_for) const;

  std::unique_ptr<Integrator> integrator_;
  std::vector<const ForceModel*> models_;
  ExternalForces external_;
  Assembler assembler_;
  std::unique_ptr<ConstrainedSolver> solver_;
  NewtonOptions newton_;
  bool chooses_core_, wants_rho_;
  double core_h_ = 0.0;
  double stiffness_ = -1.0;
  ElementCore core_of(std::span<const ForceClass> families) const;
  // The step's own, then others, with an empty mask where one before it is as good.
  std::vector<ElementCore> cores_;
  // What each leaves out of a_, relinearised_a_ and current_a_.
  std::vector<CoreRest> rests_, relinearised_rests_;
  const std::vector<CoreRest>* current_rests_ = &rests_;

  const State* state_ = nullptr;
  const ConstraintSet* constraints_ = nullptr;
  double h_ = 0.0, assemble_ms_ = 0.0;
  std::string solved_for_;  // the unknown of the step that began
  BlockCsr a_;
  BlockCsr relinearised_a_;  // of nonlinear integrators; a_ stays for the next solve
  const BlockCsr* current_a_ = nullptr;
  int newton_iterations_ = 0;
  bool guess_is_iterate_ = false;
  std::vector<Vec3> b_, rhs_, z_, guess_, current_guess_, unknown_, x_end_, v_end_, impulse_,
      given_;
};

}  // namespace taut
