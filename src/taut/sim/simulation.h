#pragma once
// A World in motion. step(h) joins contact and the step (docs/architecture.md, "What a step does"):
//
//   pins, zones and contact give constraints -> assemble -> [solve -> contact judges the constraint
//   forces] until the contacts agree -> cloth is kept from passing through cloth -> commit
//
// A solve that fails is repeated by a direct method (`fallbacks` of the report). If that fails too,
// or a stretch spring overshoots by more than overshoot_limit (element/overshoot.h), the step is
// redone as two of half the length, down to h / 2^max_halvings (`retries`). What cannot be solved
// or kept apart there makes the report not ok: the state stays that of the step before.
//
// Between steps everything but the meshes may change. No files, no global state but the threads:
// several simulations may run side by side, each used by one thread at a time.

#include <functional>
#include <memory>
#include <span>

#include "taut/sim/simulation_options.h"
#include "taut/sim/snapshot.h"
#include "taut/sim/step_report.h"
#include "taut/sim/world.h"

namespace taut {

class ClothModel;
class ConstraintSet;
class MeshSolid;
class SolidContact;
class Stepper;
class SurfaceContact;
struct ClothPart;
struct PinnedNodes;
struct SimulationState;
struct SolveSummary;
struct State;

// The stretch spring that is longest for its rest length.
struct WorstStretch {
  double stretch = 0.0;  // L/L0 - 1
  std::string cloth;
  Index i = 0, j = 0;  // its ends, nodes of the cloth
};

class Simulation {
 public:
  // Throws InvalidWorld (sim/validator.h) for values that cannot be simulated, and InputError when
  // cloth intersects at the start and world.contact does not allow it.
  explicit Simulation(World world, SimulationOptions options = {});
  virtual ~Simulation();
  Simulation(Simulation&&) = delete;

  // The next h seconds. Throws InputError for an h that is no step size.
  StepReport step(double h);
  double time() const;  // s
  int steps_done() const;

  // m and m/s, one a node of the cloth; valid until the next step.
  std::span<const Vec3> positions(ClothHandle cloth) const;
  std::span<const Vec3> velocities(ClothHandle cloth) const;

  // For the steps to come. A handle that is none of this world's, a list of another length and
  // values out of range are InputErrors.
  void set_gravity(const Vec3& gravity);  // m/s²
  void set_wind(const WindOptions& wind);
  void set_material(ClothHandle cloth, const SpringMaterial& material);
  void set_velocities(ClothHandle cloth, std::span<const Vec3> v);  // m/s, one a node
  // N, one a node, beside gravity and air, until set again.
  void set_forces(ClothHandle cloth, std::span<const Vec3> force);

  // Pinned nodes are this far (m) from where they were pinned at the end of the next step, or at
  // these places, and then stay; a path of key frames ends thereby.
  void move(PinHandle pin, const Vec3& displacement);
  void place(PinHandle pin, std::span<const Vec3> places);
  void release(PinHandle pin);
  // Held again, where the nodes are now.
  void hold(PinHandle pin);
  PinHandle pin(ClothHandle cloth, std::vector<Index> nodes);

  // The solid's pose at the end of the next step; its key frames and velocities end thereby.
  void move(SolidHandle solid, const Pose& pose);
  // All vertices of a mesh solid at the end of the next step, m, in its own coordinates.
  void deform(SolidHandle solid, std::span<const Vec3> shape);

  Snapshot save() const;
  // Throws InputError for a snapshot of another world, or of a solver that is not this one's.
  void load(const Snapshot& snapshot);

  const World& world() const;
  const SimulationOptions& options() const;
  WorstStretch worst_stretch() const;

  // The parts it is made of, for dumps, benches and one's own measurements (headers of their
  // rooms).
  const ClothModel& cloth() const;
  const State& state() const;
  const SolidContact& contact() const;
  Stepper& stepper();
  const Stepper& stepper() const;
  const ConstraintSet& constraints() const;
  // Null where contact.self is off and no solid is a mesh.
  SurfaceContact* surface_contact();
  const SurfaceContact* surface_contact() const;
  // The content of a Snapshot.
  SimulationState full_state() const;
  void set_full_state(const SimulationState& state);

  // Chooses the core for steps of up to h (s), as the first step of that length would.
  void prepare(double h);
  // Called after the last pass of a step, before it is committed: the solved system is in
  // stepper().system(). For dumps and benches. A step that is then redone in halves calls it once,
  // for the whole.
  std::function<void(const SolveSummary&)> on_solved;

 private:
  Status advance(double h, int halvings, StepReport& record);
  Status advance_halves(double h, int halvings, StepReport& record);
  Status try_step(double h, bool may_halve, double& overshoot, StepReport& record);
  Status correct(double h, std::vector<Vec3>& corrected, bool& changed, StepReport& record);
  Status accept(double h, StepReport& record);
  void note_surface_contact(StepReport& record) const;
  void look_for_intersections(StepReport& record);
  double largest_overshoot() const;
  Status solve_passes(bool may_halve, double& overshoot, StepReport& record);
  SolveSummary solve_or_fall_back();
  void note_solve(const SolveSummary& summary, StepReport& record) const;
  void note_state(StepReport& record) const;

  std::span<const Vec3> part(ClothHandle cloth, const std::vector<Vec3>& field) const;
  const ClothPart& checked(ClothHandle cloth) const;
  PinnedNodes& checked(PinHandle pin);
  std::size_t checked(SolidHandle solid) const;
  void make_stepper();
  void take(const SimulationState& state);
  void begin_moves(double h);
  void end_moves();
  void set_solid(std::size_t solid);
  MeshSolid& mesh_solid(std::size_t solid);

  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace taut
