#pragma once
// A scene in motion: the loop that joins contact and the step.
//
//   step():  pins, zones and contact give constraints -> assemble -> [solve -> contact judges the
//            constraint forces] until the contacts
//   agree -> cloth is kept from passing through cloth (sim/surface_contact.h) -> commit
//
// A solve that fails is repeated by a direct method (counted in `fallbacks`, named in the record).
// If that fails too, or a stretch spring overshoots by more than TimeOptions::overshoot_limit
// (element/overshoot.h), the step is redone as two of half the length, and each of them likewise,
// down to h / 2^max_halvings (counted in `retries`). So it is if cloth cannot be kept from passing
// through itself. What overshoots there is accepted (StepRecord::overshoot says so); what cannot be
// solved or kept apart there makes step() return a bad status with the step and time in its
// message, and the state stays that of the step before.

#include <functional>

#include "taut/contact/solid_contact.h"
#include "taut/scene/cloth_model.h"
#include "taut/sim/surface_contact.h"
#include "taut/step/stepper.h"

namespace taut {

// One row of stats.csv. Times in ms; of several contact passes, times are sums and the solver's
// numbers are the largest.
struct StepRecord {
  int step = 0;
  double time = 0.0;  // s, at the end of the step
  Index nodes = 0, dof = 0, constraints = 0;
  int contacts = 0;
  std::string solver;
  Index core_springs = 0;  // 0 when the solver has no core
  int iterations = 0;
  double relative_residual = 0.0;
  double assemble_ms = 0.0, order_ms = 0.0, factor_ms = 0.0, solve_ms = 0.0, contact_ms = 0.0,
         step_ms = 0.0;
  double kinetic_J = 0.0, elastic_J = 0.0;
  double max_stretch = 0.0;   // largest L/L0 - 1 of all stretch springs
  int bound_iterations = -1;  // -1: the solver, of several passes one of them, has no bound
  int fallbacks = 0;
  std::string precision = "double";  // of the factor; of several passes the higher one
  Index collapsed_springs = 0;
  int contact_passes = 0;
  int newton_iterations = 0;  // linear solves beyond one a pass; nonlinear integrators
  // the largest that was accepted after the last halving, share of a rest length; 0: none
  double overshoot = 0.0;
  // times that the step, or a part of it, was redone with half the length
  int retries = 0;
  int contact_moved = 0;   // nodes moved out of solids after the last pass
  double deepest_m = 0.0;  // how deep the deepest of them was
  // Cloth with cloth and mesh solids (contact/cloth_contact.h); of a step in parts, sums, of zones
  // the largest.
  Offset pairs_tested = 0;
  int near_pairs = 0, pushing_pairs = 0, impacts = 0, zones = 0, zone_nodes = 0, largest_zone = 0;
  double near_ms = 0.0, impulse_ms = 0.0, detect_ms = 0.0, zone_ms = 0.0, check_ms = 0.0;
  int intersections = -1;  // -1: not looked for
};

// A mesh or motion that was read, and a sum of what was in it (base/checksum.h).
struct InputFile {
  std::filesystem::path path;
  std::uint64_t sum = 0;
};

// The stretch spring that is longest for its rest length.
struct WorstStretch {
  double stretch = 0.0;  // L/L0 - 1
  std::string cloth;
  Index i = 0, j = 0;  // its ends, nodes of the cloth
};

class Simulation {
 public:
  // Throws InputError when the scene's meshes or names are bad.
  explicit Simulation(Scene scene);

  Status step(StepRecord& record);

  const Scene& scene() const { return scene_; }
  const ClothModel& cloth() const { return cloth_; }
  const State& state() const { return state_; }
  int steps_done() const { return steps_; }
  WorstStretch worst_stretch() const;
  // Of cloths, then of solids.
  std::vector<InputFile> input_files() const;
  const SolidContact& contact() const { return contact_; }
  Stepper& stepper() { return stepper_; }
  const Stepper& stepper() const { return stepper_; }
  const ConstraintSet& constraints() const { return constraints_; }

  // Null where `contact.self` is off and no solid is a mesh.
  SurfaceContact* surface_contact() { return surface_contact_.get(); }
  const SurfaceContact* surface_contact() const { return surface_contact_.get(); }

  // Goes on from a checkpoint.
  void restore(State state, ContactState contacts, int steps,
               std::span<const double> solver_memory = {}, ClothContactState surface_contact = {});
  // Called after the last pass of a step, before it is committed: the solved system is in
  // stepper().system(). For dumps and benches. A step that is then redone in halves calls it once,
  // for the whole.
  std::function<void(Simulation&, const SolveSummary&)> on_solved;

 private:
  Status advance(double h, int halvings, StepRecord& record);
  Status advance_halves(double h, int halvings, StepRecord& record);
  Status try_step(double h, bool may_halve, double& overshoot, StepRecord& record);
  Status correct(double h, std::vector<Vec3>& corrected, bool& changed, StepRecord& record);
  Status accept(double h, StepRecord& record);
  void note_surface_contact(StepRecord& record) const;
  void look_for_intersections(StepRecord& record);
  double largest_overshoot() const;
  Status solve_passes(bool may_halve, double& overshoot, StepRecord& record);
  SolveSummary solve_or_fall_back(StepRecord& record);
  void note_solve(const SolveSummary& summary, StepRecord& record) const;
  void note_state(StepRecord& record) const;

  Scene scene_;
  ClothModel cloth_;
  SolidContact contact_;
  std::unique_ptr<SurfaceContact> surface_contact_;
  Stepper stepper_;
  std::unique_ptr<ConstrainedSolver> fallback_;
  ConstraintSet pins_, held_, constraints_;  // held: pins and zones
  State state_;
  SolveSummary last_summary_;
  int steps_ = 0;
};

}  // namespace taut
