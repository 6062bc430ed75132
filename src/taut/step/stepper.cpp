#include "taut/step/stepper.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/constraint/reduction.h"
#include "taut/core/core_bound.h"
#include "taut/core/core_choice.h"
#include "taut/linalg/vector_ops.h"
#include "taut/step/newton.h"

namespace taut {

namespace {

std::vector<bool> implicit_models(const std::vector<const ForceModel*>& models,
                                  const Integrator& integrator) {
  std::vector<bool> implicit;
  for (const ForceModel* model : models) implicit.push_back(integrator.is_implicit(*model));
  return implicit;
}

// What may be cores beside a chosen one: the paper's, and all but what only bending couples. Each
// holds the one before it.
constexpr ForceClass unbent[] = {ForceClass::stretch, ForceClass::shear};
constexpr std::span<const ForceClass> smaller_cores[] = {std::span(unbent).first(1), unbent};

// A's row of node i times u.
Vec3 row_product(const BlockCsr& a, Index i, std::span<const Vec3> u) {
  using Block =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;
  const BlockPattern& p = *a.pattern;
  Vec3 sum = Vec3::Zero();
  for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
    sum += Block(a.block(i, k), Eigen::OuterStride<>(p.width(i))) * u[p.column[k]];
  return sum;
}

}  // namespace

Stepper::Stepper(Index nodes, std::vector<const ForceModel*> models, ExternalForces external,
                 IntegratorKind integrator, SolverOptions solver, NewtonOptions newton)
    : integrator_(make_integrator(integrator)),
      models_(std::move(models)),
      external_(std::move(external)),
      assembler_(nodes, models_, implicit_models(models_, *integrator_)),
      solver_(make_solver(solver)),
      newton_(newton),
      chooses_core_(solver.chooses_core()),
      wants_rho_(solver_->traits().needs_rho),
      a_(assembler_.pattern()) {
  cores_.push_back(core_of(smaller_cores[0]));
  rests_.resize(1);
  if (integrator_->is_nonlinear()) relinearised_a_ = a_;
  current_a_ = &a_;
  const std::size_t n = static_cast<std::size_t>(nodes);
  for (auto* field : {&b_, &rhs_, &z_, &unknown_, &x_end_, &v_end_, &impulse_})
    field->assign(n, Vec3::Zero());
}

std::vector<double> Stepper::block_bounds(double h) const {
  // An integrator's first step has the largest coefficients.
  const State first;
  return assembler_.block_bounds(integrator_->stiffness_coefficient(first, h),
                                 integrator_->damping_coefficient(first, h));
}

std::vector<LargerElement> Stepper::larger_elements(double h) const {
  const State first;
  return assembler_.larger_elements(integrator_->stiffness_coefficient(first, h),
                                    integrator_->damping_coefficient(first, h));
}

std::vector<std::uint8_t> Stepper::chosen_core(double h) const {
  return taut::choose_core(*assembler_.pattern(), block_bounds(h), external_.masses(),
                           core_target_rho, larger_elements(h));
}

std::vector<std::uint8_t> Stepper::family_core(std::span<const ForceClass> families) const {
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(assembler_.pattern()->blocks()), 0);
  for (const ForceClass family : families) {
    const std::vector<std::uint8_t> own = assembler_.core_mask(family);
    for (std::size_t k = 0; k < mask.size(); ++k) mask[k] |= own[k];
  }
  return mask;
}

ElementCore Stepper::core_of(std::span<const ForceClass> families) const {
  std::string name;
  for (const ForceClass family : families) {
    if (!name.empty()) name += '+';
    name += name_of(family);
  }
  return {name, family_core(families), assembler_};
}

Index Stepper::core_springs(std::string_view name) const {
  if (name == "all")
    return assembler_
        .elements_of(
            std::vector<std::uint8_t>(static_cast<std::size_t>(assembler_.pattern()->blocks()), 1))
        .inside;
  const auto of_name = std::ranges::find_if(
      cores_, [&](const ElementCore& core) { return core.is_there() && core.name() == name; });
  return (of_name == cores_.end() ? cores_[0] : *of_name).elements().inside;
}

void Stepper::choose_core(double h) {
  core_h_ = h;
  if (wants_rho_)
    stiffness_ = stiffness_ratio(*assembler_.pattern(), block_bounds(h), external_.masses(),
                                 larger_elements(h));
  if (!chooses_core_) return;
  cores_.clear();
  cores_.emplace_back("auto", chosen_core(h), assembler_);
  bool is_chosen = false;  // so that those that hold it bring nothing
  for (const auto families : smaller_cores) {
    ElementCore core = core_of(families);
    is_chosen |= core.mask() == cores_[0].mask();
    if (is_chosen || core.mask() == cores_.back().mask())
      core = ElementCore(core.name(), {}, assembler_);
    cores_.push_back(std::move(core));
  }
  rests_.resize(cores_.size());
  current_rests_ = &rests_;
}

void Stepper::begin(const State& state, double h) {
  Timer timer;
  state_ = &state;
  h_ = h;
  solved_for_ = integrator_->unknown(state);
  if (h > core_h_) choose_core(h);
  external_.evaluate(state.time, state.x, state.v);
  integrator_->assemble(assembler_, external_, state, h, a_, b_);
  guess_ = state.last;
  current_guess_ = guess_;
  guess_is_iterate_ = false;
  current_a_ = &a_;
  measure_cores(rests_);
  assemble_ms_ = timer.milliseconds();
}

SolveSummary Stepper::solve(const ConstraintSet& constraints, std::span<const Vec3> impulses,
                            ConstrainedSolver& solver) {
  assert(state_);
  constraints_ = &constraints;
  rhs_ = b_;
  given_.assign(impulses.begin(), impulses.end());
  const double per_impulse = integrator_->rhs_per_impulse(*state_, h_);
  for (std::size_t i = 0; i < impulses.size(); ++i) rhs_[i] += per_impulse * impulses[i];
  integrator_->prescribe(constraints, *state_, h_, z_);
  current_a_ = &a_;
  current_rests_ = &rests_;
  current_guess_ = guess_;
  guess_is_iterate_ = false;
  newton_iterations_ = 0;
  SolveSummary summary = solver.solve(system(), flat(unknown_));
  if (integrator_->is_nonlinear() && summary.status.ok())
    summary = solve_nonlinear(constraints, solver, std::move(summary));
  integrator_->finish(*state_, h_, unknown_, x_end_, v_end_);

  parallel_for(constraints.nodes(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      impulse_[i] = constraints.ndof(i) == 3
                        ? Vec3(Vec3::Zero())
                        : Vec3(constraints.constrained_part(
                                   i, row_product(*current_a_, i, unknown_) - rhs_[i]) /
                               per_impulse);
  });
  return summary;
}

SolveSummary Stepper::solve_nonlinear(const ConstraintSet& constraints, ConstrainedSolver& solver,
                                      SolveSummary first) {
  const double driving = free_norm(constraints, rhs_);
  std::vector<Vec3> external(external_.force().begin(), external_.force().end());
  for (Vec3& f : external) f *= h_;
  const double scale = driving + free_norm(constraints, external);
  const NewtonProblem problem{
      [&](std::span<const Vec3> u) { return relinearise(constraints, u); },
      [&](std::span<const Vec3> d) {
        return ordered_sum(constraints.nodes(), [&](Index begin, Index end) {
          double sum = 0.0;
          for (Index i = begin; i < end; ++i)
            sum += constraints.free_part(i, impulse_[i]).dot(d[i]);
          return sum;
        });
      },
      [&](std::span<Vec3> u) {
        current_guess_.assign(u.begin(), u.end());
        guess_is_iterate_ = true;
        return solver.solve(system(), flat(u));
      },
  };
  NewtonSummary summary = newton(problem, newton_, scale, first, unknown_);
  newton_iterations_ = summary.iterations;
  summary.linear.status = summary.status;
  return summary.linear;
}

// A and b about this unknown, r = b - A u in impulse_; |S r|_(M⁻¹).
double Stepper::relinearise(const ConstraintSet& constraints, std::span<const Vec3> unknown) {
  Timer timer;
  integrator_->finish(*state_, h_, unknown, x_end_, v_end_);
  external_.evaluate(state_->time + h_, x_end_, v_end_);
  integrator_->relinearise(assembler_, external_, h_, unknown, x_end_, v_end_, relinearised_a_,
                           rhs_);
  const double per_impulse = integrator_->rhs_per_impulse(*state_, h_);
  for (std::size_t i = 0; i < given_.size(); ++i) rhs_[i] += per_impulse * given_[i];
  current_a_ = &relinearised_a_;
  measure_cores(relinearised_rests_);
  multiply(relinearised_a_, flat(unknown), flat(impulse_));
  for (std::size_t i = 0; i < rhs_.size(); ++i) impulse_[i] = rhs_[i] - impulse_[i];
  assemble_ms_ += timer.milliseconds();
  return free_norm(constraints, impulse_);
}

double Stepper::free_norm(const ConstraintSet& constraints, std::span<const Vec3> momentum) const {
  const auto masses = external_.masses();
  return std::sqrt(ordered_sum(constraints.nodes(), [&](Index begin, Index end) {
    double sum = 0.0;
    for (Index i = begin; i < end; ++i)
      sum += constraints.free_part(i, momentum[i]).squaredNorm() / masses[i];
    return sum;
  }));
}

// Of the matrix that has just been assembled, current_a_.
void Stepper::measure_cores(std::vector<CoreRest>& rests) {
  rests.resize(cores_.size());
  measure_rests(cores_, assembler_, *current_a_, external_.masses(), wants_rho_, rests);
  current_rests_ = &rests;
}

double Stepper::remainder_ratio() const {
  if (cores_[0].leaves_larger_elements_out()) return (*current_rests_)[0].rho;
  return taut::remainder_ratio(*current_a_, cores_[0].mask(), external_.masses());
}

LinearSystem Stepper::system() const {
  LinearSystem system;
  system.matrix = current_a_;
  system.rhs = flat(rhs_);
  system.constraints = constraints_;
  system.z = flat(z_);
  system.guess = flat(current_guess_);
  system.guess_is_iterate = guess_is_iterate_;
  system.last = flat(current_guess_);
  system.stiffness = stiffness_;
  system.masses = external_.masses();
  system.core = view(cores_[0], (*current_rests_)[0]);
  for (std::size_t c = 1; c < cores_.size(); ++c)
    system.other_cores.push_back(view(cores_[c], (*current_rests_)[c]));
  if (state_) system.positions = flat(state_->x);
  return system;
}

void Stepper::commit(State& state) {
  state.x_prev = std::exchange(state.x, x_end_);
  state.v_prev = std::exchange(state.v, v_end_);
  state.last = unknown_;
  state.time += h_;
  state.has_previous = true;
  forget_other_unknown(state, solved_for_);
}

// A velocity change is no guess for a displacement: BDF2 switches between the two.
void Stepper::forget_other_unknown(State& state, const std::string& solved_for) const {
  if (integrator_->unknown(state) != solved_for) state.last.clear();
}

void Stepper::start_afresh(State& state) const {
  const std::string solved_for = integrator_->unknown(state);
  state.has_previous = false;
  forget_other_unknown(state, solved_for);
}

void Stepper::correct(State& state, std::span<const Vec3> corrected, double h) const {
  for (std::size_t i = 0; i < corrected.size(); ++i) {
    state.v[i] += (corrected[i] - state.x[i]) / h;
    state.x[i] = corrected[i];
  }
  state.has_previous = false;
  state.last = unknown_;
  forget_other_unknown(state, solved_for_);
}

}  // namespace taut
