#include "taut/sim/simulation_parts.h"

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

Simulation::Parts::Parts(World valid_world, SimulationOptions valid_options)
    : world(std::move(valid_world)),
      options(std::move(valid_options)),
      cloth(world),
      contact(make_solid_contact(world, cloth, variant_of)),
      surface_contact(SurfaceContact::wanted(world) ? std::make_unique<SurfaceContact>(world, cloth)
                                                    : nullptr),
      fallback(options.solver),
      state(cloth.start()),
      solid_targets(world.solids().size()),
      awaits_step(world.solids().size(), 0),
      shape_targets(world.solids().size()) {}

Simulation::Simulation(World world, SimulationOptions options)
    : parts_(std::make_unique<Parts>(valid(std::move(world)), valid(std::move(options)))) {
  make_stepper();
}

Simulation::~Simulation() = default;

double Simulation::time() const { return parts_->state.time; }
int Simulation::steps_done() const { return parts_->clock.steps; }
const World& Simulation::world() const { return parts_->world; }
const SimulationOptions& Simulation::options() const { return parts_->options; }
const ClothModel& Simulation::cloth() const { return parts_->cloth; }
const State& Simulation::state() const { return parts_->state; }
const SolidContact& Simulation::contact() const { return parts_->contact; }
Stepper& Simulation::stepper() { return *parts_->stepper; }
const Stepper& Simulation::stepper() const { return *parts_->stepper; }
const ConstraintSet& Simulation::constraints() const { return parts_->constraints; }
SurfaceContact* Simulation::surface_contact() { return parts_->surface_contact.get(); }
const SurfaceContact* Simulation::surface_contact() const { return parts_->surface_contact.get(); }

// A new one goes on as the old one would.
void Simulation::make_stepper() {
  ExternalForces external =
      parts_->stepper ? parts_->stepper->external() : parts_->cloth.external();
  const std::vector<double> memory =
      parts_->stepper ? parts_->stepper->solver().memory() : std::vector<double>{};
  parts_->stepper = std::make_unique<Stepper>(parts_->cloth.nodes(), parts_->cloth.force_models(),
                                              std::move(external), parts_->options.integrator,
                                              parts_->options.solver, parts_->options.newton);
  parts_->stepper->solver().restore_memory(memory);
  // Halved steps keep the core of whole ones, and its symbolic work.
  if (parts_->clock.longest > 0.0) parts_->stepper->choose_core(parts_->clock.longest);
}

void Simulation::prepare(double h) {
  if (h <= parts_->clock.longest) return;
  parts_->clock.longest = h;
  if (parts_->options.integrator == IntegratorKind::imex_adaptive) {
    parts_->cloth.make_springs(parts_->world, h);
    make_stepper();
  } else {
    parts_->stepper->choose_core(h);
  }
}

WorstStretch Simulation::worst_stretch() const {
  WorstStretch worst;
  const Spring* where = nullptr;
  for (const SpringModel* model : parts_->cloth.stretch_springs()) {
    const std::vector<double> strains = spring_strains(*model, parts_->state.x);
    for (std::size_t s = 0; s < strains.size(); ++s)
      if (!where || strains[s] > worst.stretch)
        worst.stretch = strains[s], where = &model->springs()[s];
  }
  if (!where) return worst;
  for (const ClothPart& part : parts_->cloth.parts())
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
  if (h != parts_->clock.h)
    parts_->clock.origin = parts_->state.time, parts_->clock.since_origin = 0, parts_->clock.h = h;
  StepReport record;
  record.step = parts_->clock.steps + 1;
  parts_->state.time = parts_->clock.origin + parts_->clock.since_origin * h;
  begin_moves(h);
  if (record.status = advance(h, 0, record); !record.ok()) {
    record.status.message = fmt::format("step {} (t = {:.6g} s): {}", record.step,
                                        parts_->state.time, record.status.message);
    return record;
  }
  end_moves();
  ++parts_->clock.steps;
  parts_->state.time = parts_->clock.origin + ++parts_->clock.since_origin * h;
  record.time = parts_->state.time;
  note_state(record);
  look_for_intersections(record);
  record.step_ms = timer.milliseconds();
  return record;
}

Status Simulation::advance(double h, int halvings, StepReport& record) {
  const bool may_halve = halvings < parts_->options.max_halvings;
  double beyond = 0.0;
  Status status = try_step(h, may_halve, beyond, record);
  if (status.ok() && halvings == 0 && on_solved) on_solved(parts_->last_summary);
  const bool overshot = status.ok() && beyond > parts_->options.overshoot_limit;
  if (may_halve && (!status.ok() || overshot)) return advance_halves(h, halvings, record);
  // Without halving, as in the paper, it is the user's choice to accept what comes.
  if (overshot && parts_->options.max_halvings > 0)
    record.overshoot = std::max(record.overshoot, beyond);
  if (status.ok()) status = accept(h, record);
  return status.ok() || !may_halve ? status : advance_halves(h, halvings, record);
}

Status Simulation::advance_halves(double h, int halvings, StepReport& record) {
  ++record.retries;
  const State state = parts_->state;
  const ContactState contacts = parts_->contact.state();
  const ClothContactState surface_contact =
      parts_->surface_contact ? parts_->surface_contact->state() : ClothContactState{};
  Status status;
  for (int half = 0; half < 2 && status.ok(); ++half) {
    parts_->stepper->start_afresh(parts_->state);
    status = advance(h / 2, halvings + 1, record);
  }
  if (status.ok()) {
    parts_->stepper->start_afresh(parts_->state);
  } else {
    parts_->state = state;
    parts_->contact.restore(contacts);
    if (parts_->surface_contact) parts_->surface_contact->restore(surface_contact);
    if (halvings + 1 == parts_->options.max_halvings)
      status.message += fmt::format(" (also with steps of {:.3g} s)", h / 2);
  }
  return status;
}

double Simulation::largest_overshoot() const {
  // it has iterated until the forces at the end agree
  if (parts_->stepper->integrator().is_nonlinear()) return 0.0;
  double largest = 0.0;
  for (const SpringModel* model : parts_->cloth.stretch_springs())
    largest = std::max(largest,
                       taut::largest_overshoot(*model, parts_->state.x, parts_->stepper->x_end()));
  return largest;
}

Status Simulation::try_step(double h, bool may_halve, double& overshoot, StepReport& record) {
  parts_->pins.reset(parts_->cloth.nodes());
  parts_->cloth.constrain_pins(parts_->state.time, h, parts_->state.x, parts_->pins);
  parts_->held = parts_->pins;
  if (parts_->surface_contact) parts_->surface_contact->hold_zones(parts_->state, h, parts_->held);
  parts_->stepper->begin(parts_->state, h);
  record.assemble_ms += parts_->stepper->assemble_ms();
  Timer contact_timer;
  std::vector<Vec3> predicted(parts_->state.x.size());
  for (std::size_t i = 0; i < predicted.size(); ++i)
    predicted[i] = parts_->state.x[i] + h * parts_->state.v[i];
  parts_->contact.begin_step(parts_->state.time, h, parts_->state.x, predicted, parts_->held);
  record.contact_ms += contact_timer.milliseconds();
  return solve_passes(may_halve, overshoot, record);
}

Status Simulation::correct(double h, std::vector<Vec3>& corrected, bool& changed,
                           StepReport& record) {
  changed = parts_->contact.move_out(corrected) > 0;
  if (!parts_->surface_contact) return {};
  std::vector<Vec3> v_end(parts_->stepper->v_end().begin(), parts_->stepper->v_end().end());
  if (changed)
    for (std::size_t i = 0; i < v_end.size(); ++i)
      v_end[i] += (corrected[i] - parts_->stepper->x_end()[i]) / h;
  Status status =
      parts_->surface_contact->correct(parts_->state.time, h, parts_->state.x, v_end, parts_->pins,
                                       parts_->contact, corrected, changed);
  note_surface_contact(record);
  return status;
}

Status Simulation::accept(double h, StepReport& record) {
  Timer contact_timer;
  std::vector<Vec3> corrected(parts_->stepper->x_end().begin(), parts_->stepper->x_end().end());
  bool changed = false;
  const Status status = correct(h, corrected, changed, record);
  record.contact_ms += contact_timer.milliseconds();
  if (!status.ok()) return status;
  parts_->contact.keep();
  if (parts_->surface_contact) parts_->surface_contact->keep();
  record.contact_moved += parts_->contact.counts().moved;
  record.deepest_m = std::max(record.deepest_m, parts_->contact.deepest());
  record.contacts = parts_->contact.contacts() +
                    (parts_->surface_contact ? parts_->surface_contact->counts().pushing : 0);
  parts_->stepper->commit(parts_->state);
  if (changed) parts_->stepper->correct(parts_->state, corrected, h);
  return {};
}

void Simulation::note_surface_contact(StepReport& record) const {
  const ClothContactCounts& counts = parts_->surface_contact->counts();
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
  const int every = parts_->world.contact.check_every;
  if (!parts_->surface_contact || every == 0 || parts_->clock.steps % every != 0) return;
  Timer timer;
  record.intersections = static_cast<int>(
      parts_->surface_contact->intersections(parts_->state.time, parts_->state.x).size());
  record.check_ms = timer.milliseconds();
}

// Where the step may be halved, it ends with the first pass that overshoots: the others would be
// solved for nothing.
Status Simulation::solve_passes(bool may_halve, double& overshoot, StepReport& record) {
  SolveSummary summary;
  for (bool again = true; again;) {
    parts_->constraints = parts_->held;
    Timer contact_timer;
    parts_->contact.constrain(parts_->constraints);
    record.contact_ms += contact_timer.milliseconds();
    const double assembled = parts_->stepper->assemble_ms();
    summary = solve_or_fall_back();
    record.assemble_ms += parts_->stepper->assemble_ms() - assembled;
    note_solve(summary, record);
    ++record.contact_passes;
    if (!summary.status.ok()) return summary.status;
    overshoot = largest_overshoot();
    contact_timer.lap();
    again = !(may_halve && overshoot > parts_->options.overshoot_limit) &&
            parts_->contact.update(parts_->stepper->x_end(), parts_->stepper->constraint_impulse());
    record.contact_ms += contact_timer.milliseconds();
  }
  record.dof = parts_->constraints.free_dofs();
  record.constraints = parts_->constraints.constrained_dofs();
  parts_->last_summary = std::move(summary);
  return {};
}

SolveSummary Simulation::solve_or_fall_back() {
  return parts_->fallback.solve(parts_->stepper->solver(), [&](ConstrainedSolver& solver) {
    return parts_->stepper->solve(parts_->constraints, parts_->contact.impulses(), solver);
  });
}

void Simulation::note_solve(const SolveSummary& summary, StepReport& record) const {
  record.solver = summary.method;
  record.newton_iterations += parts_->stepper->newton_iterations();
  record.fallbacks += summary.fallbacks;
  if (record.contact_passes == 0 || summary.precision == std::string_view("double"))
    record.precision = summary.precision;
  record.iterations = std::max(record.iterations, summary.iterations);
  record.relative_residual = std::max(record.relative_residual, summary.relative_residual);
  record.order_ms += summary.order_ms;
  record.factor_ms += summary.factor_ms;
  record.solve_ms += summary.solve_ms + summary.reduce_ms;
  if (solver_traits(summary.method).bounds_iterations)
    record.core_springs = parts_->stepper->core_springs(summary.core);
  // `auto` may change its method between passes: iterations of one without a bound are not to be
  // held against another's.
  const int bound = summary.bound_iterations;
  const bool bounded = bound >= 0 && (record.contact_passes == 0 || record.bound_iterations >= 0);
  record.bound_iterations = bounded ? std::max(record.bound_iterations, bound) : -1;
}

void Simulation::note_state(StepReport& record) const {
  record.nodes = parts_->cloth.nodes();
  const auto masses = parts_->cloth.external().masses();
  record.kinetic_J = ordered_sum(parts_->cloth.nodes(), [&](Index begin, Index end) {
    double sum = 0.0;
    for (Index i = begin; i < end; ++i) sum += 0.5 * masses[i] * parts_->state.v[i].squaredNorm();
    return sum;
  });
  for (const auto& model : parts_->cloth.springs()) {
    record.elastic_J += model->energy(parts_->state.x);
    record.collapsed_springs += model->collapsed(parts_->state.x);
  }
  for (const SpringModel* model : parts_->cloth.stretch_springs())
    record.max_stretch = std::max(record.max_stretch, largest_strain(*model, parts_->state.x));
}

}  // namespace taut
