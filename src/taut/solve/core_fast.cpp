#include "taut/solve/core_fast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/core/core_bound.h"
#include "taut/core/replacement_choice.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/full_space.h"
#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/reduced_pcg.h"

namespace taut {

namespace {

// How far above the usual rounding, in units of itself, the residual is looked at.
constexpr double look_above = 2.0;
// The largest rounding that is taken for harmless, as a share of the error that the stop test
// allows, and the most that it is taken to allow.
constexpr double harmless_share = 0.5;
constexpr double most_allowed = 3.0;  // tolerances
// The true residual is what was believed if it is at most this many times as large.
constexpr double as_believed = 2.0;
// Where rounding may be larger than this beside the masses, single precision is not tried: it would
// fail in most steps.
constexpr double too_large_for_single = 2.0;
// With products from A, the factor in single precision is looked at when convergence is slow, and
// taken for bad when it misjudges a direction's energy by this share: then its rounding, not the
// springs outside the core, sets the number of iterations.
constexpr int check_every = 8;
constexpr double worst_quality = 0.3;

// What products known from a factor leave, relative to what the loop began with.
struct Rounding {
  double usual = 0.0, worst = 0.0;
};

Rounding rounding_in_single(const LinearSystem& system) {
  constexpr double unit = 0x1p-24;
  if (system.stiffness < 0.0) return {CoreFast::unknown_rounding, 1.0};
  return {4.0 * unit * std::sqrt(1.0 + system.stiffness), 0.22 * unit * (1.0 + system.stiffness)};
}

// y = P x: the blocks of the mask.
void multiply_masked(const BlockCsr& a, std::span<const std::uint8_t> mask,
                     std::span<const double> x, std::span<double> y) {
  const BlockPattern& p = *a.pattern;
  parallel_for(p.rows(), 256, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index rows = p.dim(i), width = p.width(i);
      for (Index r = 0; r < rows; ++r) y[p.dof_start[i] + r] = 0.0;
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
        if (!mask[k]) continue;
        const double* block = a.block(i, k);
        const Index from = p.column_dof[k];
        for (Index r = 0; r < rows; ++r)
          for (Index c = 0; c < p.dim(p.column[k]); ++c)
            y[p.dof_start[i] + r] += block[r * width + c] * x[from + c];
      }
    }
  });
}

}  // namespace

bool CoreFast::analyze_if_new(const LinearSystem& system, SolveSummary& summary) {
  const bool has_matrix = system.core.matrix != nullptr;
  const bool is_known = pattern_ == system.matrix->pattern && has_matrix == has_matrix_ &&
                        (system.core.mask.empty() ? std::ranges::equal(mask_, core_mask(system))
                                                  : std::ranges::equal(mask_, system.core.mask));
  if (is_known) return true;
  mask_ = core_mask(system);
  pattern_ = system.matrix->pattern;
  has_matrix_ = has_matrix;
  factor_.set_precision(CholeskyPrecision::single_precision);
  summary.status = factor_.analyze(
      pattern_, mask_, has_matrix ? BlocksLeftOut::all_outside_mask : BlocksLeftOut::without_place);
  if (!summary.status.ok()) {
    pattern_ = nullptr;
    return false;
  }
  if (pattern_->uniform_dim == 3 && !has_matrix_) {
    remainder_.analyze(pattern_, factor_.analyzed_blocks(), factor_.parallelograms());
    ratios_.resize(static_cast<std::size_t>(remainder_.batches()));
  }
  return true;
}

bool CoreFast::factorize(CholeskyPrecision precision, const LinearSystem& system,
                         SolveSummary& summary) {
  factor_.set_precision(precision);
  summary.precision = precision == CholeskyPrecision::single_precision ? "single" : "double";
  const BlockCsr& p = core_of(system);
  const NodeBasis basis = free_basis(system);
  knows_products_ = lumped_ && precision == CholeskyPrecision::single_precision;
  BlocksOutside outside{lumped_, replaced_};
  if (knows_products_ || replaced_)
    outside.visit = [&](Index begin, Index end) { remainder_.update_rows(p, begin, end); };
  if (replaced_)
    outside.beside = {remainder_.batches(), [&](Index batch) {
                        ratios_[batch] = remainder_.ratios_in(batch, system.masses);
                      }};
  if (starts_at_rest_) {
    summary.status = factor_.factorize(p, basis, r_, &delta0_, outside);
    delta_ = delta0_;
  } else {
    summary.status = factor_.factorize(p, basis, load_, delta0_, r_, delta_, outside);
  }
  if (summary.status.ok() && !std::isfinite(delta0_))
    summary.status = {Outcome::not_finite, "the right-hand side overflows the factor's precision"};
  return summary.status.ok();
}

bool CoreFast::begin_in_double(const LinearSystem& system, bool single_has_failed,
                               SolveSummary& summary) {
  if (single_has_failed) {
    summary.remark = fmt::format("double precision: {}", summary.status.message);
    ++summary.fallbacks;
  }
  if (factorize(CholeskyPrecision::double_precision, system, summary)) return true;
  if (!lumped_ || summary.status.outcome != Outcome::not_positive_definite) return false;
  // Not what springs alone would leave.
  lumped_ = false;
  take_outside(system);
  condition_ = -1.0;
  summary.remark += fmt::format("{}the blocks outside the core not lumped: {}",
                                summary.remark.empty() ? "" : "; ", summary.status.message);
  ++summary.fallbacks;
  return factorize(CholeskyPrecision::double_precision, system, summary);
}

// What becomes of the springs outside the core, but for whether they are lumped.
void CoreFast::take_outside(const LinearSystem& system) {
  replaced_ = lumped_ && !system.masses.empty() && !system.last.empty() &&
              replacing_pays(*system.matrix, factor_.parallelograms(), system.last);
  remainder_.set_replaced(replaced_);
  condition_ = system.core.condition();
  excess_ = 1.0;
}

// For what is replaced, once the factorisation has taken the remainder from the matrix.
void CoreFast::bound_replaced() {
  if (!replaced_) return;
  const BlockRemainder::Ratios ratio = BlockRemainder::largest(ratios_);
  excess_ = 1.0 + 4.0 * ratio.replaced;
  condition_ = excess_ * (1.0 + 2.0 * ratio.dropped);
}

// For the search direction c, whose product with A is in q, and w = P c: wᵀ P̃⁻¹ w / cᵀ w, which is
// 1 but for the factor's rounding. Takes q_ for w.
double CoreFast::factor_quality(const LinearSystem& system) {
  if (lumped_) {
    remainder_.subtract(c_, q_);
  } else {
    multiply_masked(core_of(system), factor_.analyzed_blocks(), c_, q_);
  }
  const double energy = dot(c_, q_);
  return factor_.solve_forward(q_) / energy;
}

const BlockCsr& CoreFast::core_of(const LinearSystem& system) const {
  return has_matrix_ ? *system.core.matrix : *system.matrix;
}

void CoreFast::residual(const LinearSystem& system, std::span<const double> x) {
  multiply_dot(*system.matrix, x, r_);
  residual_from_product(system.rhs, r_);
}

// x, its residual, and the load. At rest, x = (I-S) z, the residual is the load.
void CoreFast::start(const LinearSystem& system, std::span<double> x) {
  starts_at_rest_ = system.guess.empty() || !system.guess_is_iterate;
  LinearSystem from_rest = system;
  if (starts_at_rest_) from_rest.guess = {};
  initial_guess(from_rest, x);
  load_without_prescribed(system, starts_at_rest_ ? r_ : load_);
  if (!starts_at_rest_) residual(system, x);
}

// Conjugate gradients for the residual in r_, whose forward solve came with the factorisation, from
// x on; `done` iterations came before.
KrylovResult CoreFast::iterate(const LinearSystem& system, std::span<double> x, int done,
                               int max_iterations, bool in_single) {
  const BlockCsr& a = *system.matrix;
  KrylovResult result;
  const Rounding rounding = rounding_in_single(system);
  const double scale = std::sqrt(delta0_), limit = options_.tolerance * scale,
               allowed = condition_ > 0.0 ? std::min(most_allowed, std::sqrt(condition_)) : 1.0;
  // |error|_A / |x|_A may be `allowed` tolerances by the stop test
  const double harmless = harmless_share * allowed * limit;
  double delta = delta_, previous = 0.0;  // previous: of the direction in c_; 0 begins anew
  double seen = std::sqrt(delta);         // of the last residual that came from A itself
  // of this part of the loop: where it began, what it had to reach
  double begin = seen, aim = limit;
  int begin_iterations = 0;  // and the iterations before it
  bool is_true = true, is_indefinite = false;
  // Products are taken from A: where known ones might not be exact enough, this is less than a look
  // at the end.
  bool from_a = !knows_products_ || rounding.worst * seen > harmless;
  result.start_value = begin / scale;
  if (coefficients) *coefficients = {};
  const auto end_part = [&] {
    if (condition_ > 0.0)
      bound_iterations_ += iteration_bound(condition_, begin / scale, aim / scale);
  };
  while (true) {
    const double size = std::sqrt(std::abs(delta));
    if (!(size > limit) && (is_true || rounding.worst * seen <= harmless)) break;
    if (aim = std::max(limit, look_above * rounding.usual * seen); !is_true && size <= aim) {
      residual(system, x);
      const double now = std::sqrt(factor_.solve_forward(r_));
      if (!(now <= as_believed * size))
        end_part(), begin = now, begin_iterations = result.iterations, previous = 0.0,
                    from_a = true;
      delta = now * now, seen = now, is_true = true;
      continue;
    }
    if (!(size > limit) || result.iterations >= max_iterations) break;
    if (in_single && condition_ > 0.0 &&
        result.iterations - begin_iterations >=
            iteration_bound(condition_, begin / scale, aim / scale)) {
      result.status = {Outcome::breakdown,
                       fmt::format("more than the {} iterations that the core allows: its factor "
                                   "is not exact enough in single precision",
                                   result.iterations - begin_iterations)};
      break;
    }
    const double beta = previous == 0.0 ? 0.0 : delta / previous;
    factor_.solve_backward(beta, c_);
    const double curvature =
        from_a ? multiply_dot(a, c_, q_) : remainder_.advance(beta, r_, c_, p_, q_);
    if (!(curvature > 0.0)) {
      is_indefinite = true;
      break;
    }
    const double alpha = delta / curvature;
    const double largest = step_along(alpha, c_, q_, x, r_);
    energy_ += alpha * delta;
    is_true = from_a;
    if (from_a && in_single && result.iterations % check_every == check_every - 1) {
      if (const double quality = factor_quality(system);
          !(std::abs(quality - 1.0) < worst_quality)) {
        ++result.iterations;
        result.status = {Outcome::breakdown,
                         fmt::format("after {} iterations the factor in single precision is wrong "
                                     "by {:.2g} along the search direction",
                                     result.iterations, quality - 1.0)};
        break;
      }
    }
    previous = delta;
    delta = factor_.solve_forward(r_, largest);
    ++result.iterations;
    if (coefficients)
      coefficients->alpha.push_back(alpha), coefficients->beta.push_back(delta / previous);
    if (observer) observer(done + result.iterations, std::sqrt(std::abs(delta)) / scale, x);
  }
  aim = limit;
  end_part();
  result.stop_value = std::sqrt(std::abs(delta)) / scale;
  if (!result.status.ok()) return result;
  if (!std::isfinite(delta)) {
    result.status = {
        Outcome::not_finite,
        fmt::format("the residual is not finite after {} iterations", result.iterations)};
  } else if (is_indefinite) {
    result.status = {Outcome::not_positive_definite,
                     fmt::format("a search direction of curvature <= 0 after {} iterations: the "
                                 "matrix is not positive definite",
                                 result.iterations)};
  } else if (result.stop_value > options_.tolerance) {
    result.status = {Outcome::max_iterations,
                     fmt::format("{} iterations reach {:.3g}, not {:.3g}", result.iterations,
                                 result.stop_value, options_.tolerance)};
  }
  return result;
}

void CoreFast::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  const BlockCsr& a = *system.matrix;
  Timer timer;
  if (!analyze_if_new(system, summary)) return initial_guess(system, x);
  summary.order_ms = timer.lap();
  summary.core = system.core.name;
  for (auto* v : {&load_, &r_, &c_, &p_, &q_}) v->resize(x.size());
  start(system, x);
  summary.reduce_ms = timer.lap();
  lumped_ = !has_matrix_ && system.core.rho >= 0.0 && system.matrix->pattern->uniform_dim == 3;
  take_outside(system);
  summary.solve_ms = timer.lap();
  const bool tries_single = !(rounding_in_single(system).worst > too_large_for_single);
  const bool in_single =
      tries_single && factorize(CholeskyPrecision::single_precision, system, summary);
  if (!in_single && !begin_in_double(system, tries_single, summary)) return;
  bound_replaced();
  summary.factor_ms = timer.lap();

  const int limit = iteration_limit(a.dofs());
  KrylovResult result;
  bound_iterations_ = 0;
  energy_ = 0.0;
  const bool from_rest = starts_at_rest_;
  if (delta0_ == 0.0) {
    LinearSystem at_rest = system;
    at_rest.guess = {};
    initial_guess(at_rest, x);
  } else {
    result = iterate(system, x, 0, limit, in_single);
  }
  summary.solve_ms += timer.lap();
  const int done = result.iterations;
  if (in_single && !result.status.ok() && done < limit) {
    const KrylovResult first = result;
    summary.status = first.status;
    if (!all_finite(x)) initial_guess(system, x);
    starts_at_rest_ = false;
    load_without_prescribed(system, load_);
    residual(system, x);
    if (!begin_in_double(system, true, summary)) return;
    summary.factor_ms += timer.lap();
    result = iterate(system, x, done, limit - done, false);
    result.iterations += done;
    result.start_value = first.start_value;
    summary.solve_ms += timer.lap();
  }
  take_over(result, summary);
  summary.replaced = replaced_;
  summary.condition = condition_;
  if (condition_ > 0.0) {
    summary.bound_iterations = bound_iterations_;
  } else if (std::ranges::count(factor_.analyzed_blocks(), 0) > 0) {
    summary.remark +=
        fmt::format("{}no bound: what the core leaves out is not known to be elements of two nodes",
                    summary.remark.empty() ? "" : "; ");
  }
  const bool is_below_a = lumped_ || has_matrix_;
  if (is_below_a && from_rest && energy_ > 0.0)
    summary.error_bound = result.stop_value * std::sqrt(excess_ * delta0_ / energy_);
  summary.factor_nonzeros = factor_.statistics().nonzeros;
  summary.factor_flops = factor_.statistics().flops;
  if (pattern_->uniform_dim == 3)
    summary.left_out_nonzeros =
        static_cast<double>(has_matrix_ ? pattern_->value_count() : remainder_.nonzeros());
  summary.memory_bytes = factor_.statistics().bytes + static_cast<double>(remainder_.bytes()) +
                         5.0 * sizeof(double) * static_cast<double>(x.size());
}

}  // namespace taut
