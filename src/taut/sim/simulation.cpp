#include "taut/sim/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/element/overshoot.h"
#include "taut/sim/describe.h"
#include "taut/sim/solid_variants.h"
#include "taut/sim/validator.h"
#include "taut/solve/solver_registry.h"

namespace taut {

namespace {

World valid(World world) {
  world.validate();
  return world;
}

SimulationOptions valid(SimulationOptions options) {
  Validator v;
  SimulationOptions copy = options;
  v.inside("", [&] {
    v.table("solver", {}, [&] { describe_solver(v, copy.solver); });
    describe_integration(v, copy.integrator, copy.newton, copy.overshoot_limit, copy.max_halvings);
  });
  v.finish();
  return options;
}

SolidContact make_solid_contact(const World& world, const ClothModel& cloth,
                                std::vector<int>& variant_of) {
  SolidVariants variants = solid_variants(world, cloth);
  variant_of = std::move(variants.of);
  return SolidContact(std::move(variants.solids), cloth.nodes(), world.contact,
                      std::move(variants.meets));
}

}  // namespace

Simulation::Simulation(World world, SimulationOptions options)
    : world_(valid(std::move(world))),
      options_(valid(std::move(options))),
      cloth_(world_),
      contact_(make_solid_contact(world_, cloth_, variant_of_)),
      surface_contact_(SurfaceContact::wanted(world_)
                           ? std::make_unique<SurfaceContact>(world_, cloth_)
                           : nullptr),
      fallback_(options_.solver),
      state_(cloth_.start()),
      solid_targets_(world_.solids().size()),
      awaits_step_(world_.solids().size(), 0),
      shape_targets_(world_.solids().size()) {
  make_stepper();
}

Simulation::~Simulation() = default;

// A new one goes on as the old one would.
void Simulation::make_stepper() {
  ExternalForces external = stepper_ ? stepper_->external() : cloth_.external();
  const std::vector<double> memory = stepper_ ? stepper_->solver().memory() : std::vector<double>{};
  stepper_ = std::make_unique<Stepper>(cloth_.nodes(), cloth_.force_models(), std::move(external),
                                       options_.integrator, options_.solver, options_.newton);
  stepper_->solver().restore_memory(memory);
  // Halved steps keep the core of whole ones, and its symbolic work.
  if (clock_.longest > 0.0) stepper_->choose_core(clock_.longest);
}

void Simulation::prepare(double h) {
  if (h <= clock_.longest) return;
  clock_.longest = h;
  if (options_.integrator == IntegratorKind::imex_adaptive) {
    cloth_.make_springs(world_, h);
    make_stepper();
  } else {
    stepper_->choose_core(h);
  }
}

WorstStretch Simulation::worst_stretch() const {
  WorstStretch worst;
  const Spring* where = nullptr;
  for (const SpringModel* model : cloth_.stretch_springs()) {
    const std::vector<double> strains = spring_strains(*model, state_.x);
    for (std::size_t s = 0; s < strains.size(); ++s)
      if (!where || strains[s] > worst.stretch)
        worst.stretch = strains[s], where = &model->springs()[s];
  }
  if (!where) return worst;
  for (const ClothPart& part : cloth_.parts())
    if (where->i >= part.first_node && where->i < part.first_node + part.node_count)
      worst.cloth = part.name, worst.i = where->i - part.first_node,
      worst.j = where->j - part.first_node;
  return worst;
}

StepReport Simulation::step(double h) {
  Timer timer;
  {
    Validator v;
    v.inside("", [&] { describe_step(v, h); });
    v.finish();
  }
  prepare(h);
  if (h != clock_.h) clock_.origin = state_.time, clock_.since_origin = 0, clock_.h = h;
  StepReport record;
  record.step = clock_.steps + 1;
  state_.time = clock_.origin + clock_.since_origin * h;
  begin_moves(h);
  if (record.status = advance(h, 0, record); !record.ok()) {
    record.status.message =
        fmt::format("step {} (t = {:.6g} s): {}", record.step, state_.time, record.status.message);
    return record;
  }
  end_moves();
  ++clock_.steps;
  state_.time = clock_.origin + ++clock_.since_origin * h;
  record.time = state_.time;
  note_state(record);
  look_for_intersections(record);
  record.step_ms = timer.milliseconds();
  return record;
}

Status Simulation::advance(double h, int halvings, StepReport& record) {
  const bool may_halve = halvings < options_.max_halvings;
  double beyond = 0.0;
  Status status = try_step(h, may_halve, beyond, record);
  if (status.ok() && halvings == 0 && on_solved) on_solved(last_summary_);
  const bool overshot = status.ok() && beyond > options_.overshoot_limit;
  if (may_halve && (!status.ok() || overshot)) return advance_halves(h, halvings, record);
  // Without halving, as in the paper, it is the user's choice to accept what comes.
  if (overshot && options_.max_halvings > 0) record.overshoot = std::max(record.overshoot, beyond);
  if (status.ok()) status = accept(h, record);
  return status.ok() || !may_halve ? status : advance_halves(h, halvings, record);
}

Status Simulation::advance_halves(double h, int halvings, StepReport& record) {
  ++record.retries;
  const State state = state_;
  const ContactState contacts = contact_.state();
  const ClothContactState surface_contact =
      surface_contact_ ? surface_contact_->state() : ClothContactState{};
  Status status;
  for (int half = 0; half < 2 && status.ok(); ++half) {
    stepper_->start_afresh(state_);
    status = advance(h / 2, halvings + 1, record);
  }
  if (status.ok()) {
    stepper_->start_afresh(state_);
  } else {
    state_ = state;
    contact_.restore(contacts);
    if (surface_contact_) surface_contact_->restore(surface_contact);
    if (halvings + 1 == options_.max_halvings)
      status.message += fmt::format(" (also with steps of {:.3g} s)", h / 2);
  }
  return status;
}

double Simulation::largest_overshoot() const {
  // it has iterated until the forces at the end agree
  if (stepper_->integrator().is_nonlinear()) return 0.0;
  double largest = 0.0;
  for (const SpringModel* model : cloth_.stretch_springs())
    largest = std::max(largest, taut::largest_overshoot(*model, state_.x, stepper_->x_end()));
  return largest;
}

Status Simulation::try_step(double h, bool may_halve, double& overshoot, StepReport& record) {
  pins_.reset(cloth_.nodes());
  cloth_.constrain_pins(state_.time, h, state_.x, pins_);
  held_ = pins_;
  if (surface_contact_) surface_contact_->hold_zones(state_, h, held_);
  stepper_->begin(state_, h);
  record.assemble_ms += stepper_->assemble_ms();
  Timer contact_timer;
  std::vector<Vec3> predicted(state_.x.size());
  for (std::size_t i = 0; i < predicted.size(); ++i) predicted[i] = state_.x[i] + h * state_.v[i];
  contact_.begin_step(state_.time, h, state_.x, predicted, held_);
  record.contact_ms += contact_timer.milliseconds();
  return solve_passes(may_halve, overshoot, record);
}

Status Simulation::correct(double h, std::vector<Vec3>& corrected, bool& changed,
                           StepReport& record) {
  changed = contact_.move_out(corrected) > 0;
  if (!surface_contact_) return {};
  std::vector<Vec3> v_end(stepper_->v_end().begin(), stepper_->v_end().end());
  if (changed)
    for (std::size_t i = 0; i < v_end.size(); ++i)
      v_end[i] += (corrected[i] - stepper_->x_end()[i]) / h;
  Status status = surface_contact_->correct(state_.time, h, state_.x, v_end, pins_, contact_,
                                            corrected, changed);
  note_surface_contact(record);
  return status;
}

Status Simulation::accept(double h, StepReport& record) {
  Timer contact_timer;
  std::vector<Vec3> corrected(stepper_->x_end().begin(), stepper_->x_end().end());
  bool changed = false;
  const Status status = correct(h, corrected, changed, record);
  record.contact_ms += contact_timer.milliseconds();
  if (!status.ok()) return status;
  contact_.keep();
  if (surface_contact_) surface_contact_->keep();
  record.contact_moved += contact_.counts().moved;
  record.deepest_m = std::max(record.deepest_m, contact_.deepest());
  record.contacts =
      contact_.contacts() + (surface_contact_ ? surface_contact_->counts().pushing : 0);
  stepper_->commit(state_);
  if (changed) stepper_->correct(state_, corrected, h);
  return {};
}

void Simulation::note_surface_contact(StepReport& record) const {
  const ClothContactCounts& counts = surface_contact_->counts();
  record.pairs_tested += counts.tested;
  record.near_pairs = counts.near;
  record.pushing_pairs = counts.pushing;
  record.impacts += counts.impacts;
  record.zones = std::max(record.zones, counts.zones);
  record.zone_nodes = std::max(record.zone_nodes, counts.zone_nodes);
  record.largest_zone = std::max(record.largest_zone, counts.largest_zone);
  record.near_ms += counts.near_ms;
  record.impulse_ms += counts.impulse_ms;
  record.detect_ms += counts.detect_ms;
  record.zone_ms += counts.zone_ms;
}

void Simulation::look_for_intersections(StepReport& record) {
  const int every = world_.contact.check_every;
  if (!surface_contact_ || every == 0 || clock_.steps % every != 0) return;
  Timer timer;
  record.intersections =
      static_cast<int>(surface_contact_->intersections(state_.time, state_.x).size());
  record.check_ms = timer.milliseconds();
}

// Where the step may be halved, it ends with the first pass that overshoots: the others would be
// solved for nothing.
Status Simulation::solve_passes(bool may_halve, double& overshoot, StepReport& record) {
  SolveSummary summary;
  for (bool again = true; again;) {
    constraints_ = held_;
    Timer contact_timer;
    contact_.constrain(constraints_);
    record.contact_ms += contact_timer.milliseconds();
    const double assembled = stepper_->assemble_ms();
    summary = solve_or_fall_back();
    record.assemble_ms += stepper_->assemble_ms() - assembled;
    note_solve(summary, record);
    ++record.contact_passes;
    if (!summary.status.ok()) return summary.status;
    overshoot = largest_overshoot();
    contact_timer.lap();
    again = !(may_halve && overshoot > options_.overshoot_limit) &&
            contact_.update(stepper_->x_end(), stepper_->constraint_impulse());
    record.contact_ms += contact_timer.milliseconds();
  }
  record.dof = constraints_.free_dofs();
  record.constraints = constraints_.constrained_dofs();
  last_summary_ = std::move(summary);
  return {};
}

SolveSummary Simulation::solve_or_fall_back() {
  return fallback_.solve(stepper_->solver(), [&](ConstrainedSolver& solver) {
    return stepper_->solve(constraints_, contact_.impulses(), solver);
  });
}

void Simulation::note_solve(const SolveSummary& summary, StepReport& record) const {
  record.solver = summary.method;
  record.newton_iterations += stepper_->newton_iterations();
  record.fallbacks += summary.fallbacks;
  if (record.contact_passes == 0 || summary.precision == std::string_view("double"))
    record.precision = summary.precision;
  record.iterations = std::max(record.iterations, summary.iterations);
  record.relative_residual = std::max(record.relative_residual, summary.relative_residual);
  record.order_ms += summary.order_ms;
  record.factor_ms += summary.factor_ms;
  record.solve_ms += summary.solve_ms + summary.reduce_ms;
  if (solver_traits(summary.method).bounds_iterations)
    record.core_springs = stepper_->core_springs(summary.core);
  // `auto` may change its method between passes: iterations of one without a bound are not to be
  // held against another's.
  const int bound = summary.bound_iterations;
  const bool bounded = bound >= 0 && (record.contact_passes == 0 || record.bound_iterations >= 0);
  record.bound_iterations = bounded ? std::max(record.bound_iterations, bound) : -1;
}

void Simulation::note_state(StepReport& record) const {
  record.nodes = cloth_.nodes();
  const auto masses = cloth_.external().masses();
  record.kinetic_J = ordered_sum(cloth_.nodes(), [&](Index begin, Index end) {
    double sum = 0.0;
    for (Index i = begin; i < end; ++i) sum += 0.5 * masses[i] * state_.v[i].squaredNorm();
    return sum;
  });
  for (const auto& model : cloth_.springs()) {
    record.elastic_J += model->energy(state_.x);
    record.collapsed_springs += model->collapsed(state_.x);
  }
  for (const SpringModel* model : cloth_.stretch_springs())
    record.max_stretch = std::max(record.max_stretch, largest_strain(*model, state_.x));
}

}  // namespace taut
