#include "taut/solve/core_fast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/timer.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/core_bound.h"
#include "taut/solve/full_space.h"
#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/reduced_pcg.h"

namespace taut {

namespace {

// The rounding that is taken for harmless, as a share of the tolerance; and how far above it, in units of itself, the residual is looked at.
constexpr double harmless_share = 0.5;
constexpr double look_above = 2.0;
// The true residual is what was believed if it is at most this many times as large.
constexpr double as_believed = 2.0;
// The factor is bad where the true residual is more than this share of the last one.
constexpr double least_gain = 0.3;

double rounding_of(const LinearSystem& system, bool in_single) {
  if (!in_single) return 0.0;
  return system.stiffness >= 0.0 ? 4.0 * 0x1p-24 * std::sqrt(1.0 + system.stiffness) : CoreFast::unknown_rounding;
}

}  // namespace

bool CoreFast::analyze_if_new(const LinearSystem& system, SolveSummary& summary) {
  const bool is_known = pattern_ == system.matrix->pattern &&
                        (system.core.empty() ? std::ranges::equal(mask_, core_mask(system)) : std::ranges::equal(mask_, system.core));
  if (is_known) return true;
  mask_ = core_mask(system);
  pattern_ = system.matrix->pattern;
  factor_.set_precision(CholeskyPrecision::single_precision);
  summary.status = factor_.analyze(pattern_, mask_, BlocksLeftOut::without_place);
  if (!summary.status.ok()) {
    pattern_ = nullptr;
    return false;
  }
  remainder_.analyze(pattern_, factor_.analyzed_blocks());
  return true;
}

bool CoreFast::factorize(CholeskyPrecision precision, const LinearSystem& system, SolveSummary& summary) {
  factor_.set_precision(precision);
  summary.precision = precision == CholeskyPrecision::single_precision ? "single" : "double";
  const NodeBasis basis = free_basis(system);
  if (starts_at_rest_) {
    summary.status = factor_.factorize(*system.matrix, basis, load_, &delta0_);
    delta_ = delta0_;
  } else {
    summary.status = factor_.factorize(*system.matrix, basis, load_, delta0_, r_, delta_);
  }
  if (summary.status.ok() && !std::isfinite(delta0_))
    summary.status = {Outcome::not_finite, "the right-hand side overflows the factor's precision"};
  return summary.status.ok();
}

bool CoreFast::begin_in_double(const LinearSystem& system, SolveSummary& summary) {
  summary.remark = fmt::format("double precision: {}", summary.status.message);
  ++summary.fallbacks;
  return factorize(CholeskyPrecision::double_precision, system, summary);
}

void CoreFast::residual(const LinearSystem& system, std::span<const double> x) {
  multiply_dot(*system.matrix, x, r_);
  residual_from_product(system.rhs, r_);
}

// x and its residual. At rest, x = (I-S) z, that is the load.
void CoreFast::start(const LinearSystem& system, std::span<double> x) {
  starts_at_rest_ = system.guess.empty() || !system.guess_is_iterate;
  LinearSystem from_rest = system;
  if (starts_at_rest_) from_rest.guess = {};
  initial_guess(from_rest, x);
  if (starts_at_rest_) {
    std::ranges::copy(load_, r_.begin());
  } else {
    residual(system, x);
  }
}

// Conjugate gradients for the residual in r_, whose forward solve came with the factorisation, from x on; `done` iterations came before.
KrylovResult CoreFast::iterate(const LinearSystem& system, std::span<double> x, int done, int max_iterations, bool in_single) {
  KrylovResult result;
  const double rounding = rounding_of(system, in_single), scale = std::sqrt(delta0_), limit = options_.tolerance * scale;
  double delta = delta_, previous = 0.0;  // previous: of the direction in c_; 0 begins anew
  double seen = std::sqrt(delta);         // of the last residual that came from A itself
  double begin = seen, aim = limit;       // of this part of the loop: where it began, what it had to reach
  bool is_true = true, is_indefinite = false;
  result.start_value = begin / scale;
  if (coefficients) *coefficients = {};
  std::ranges::fill(p_, 0.0);
  const auto end_part = [&] {
    if (system.rho >= 0.0) bound_iterations_ += core_iteration_bound(system.rho, begin / scale, aim / scale);
  };
  while (true) {
    const double size = std::sqrt(std::abs(delta));
    if (!(size > limit) && (is_true || rounding * seen <= harmless_share * limit)) break;
    if (aim = std::max(limit, look_above * rounding * seen); !is_true && size <= aim) {
      residual(system, x);
      const double now = std::sqrt(factor_.solve_forward(r_));
      if (!(now < std::max(limit, least_gain * seen))) {
        result.status = {Outcome::breakdown,
                         fmt::format("the factor in single precision left {:.2g} of the residual after {} iterations", now / seen, result.iterations)};
        break;
      }
      if (now > as_believed * size) end_part(), begin = now, previous = 0.0;
      delta = now * now, seen = now, is_true = true;
      continue;
    }
    if (!(size > limit) || result.iterations >= max_iterations) break;
    const double beta = previous == 0.0 ? 0.0 : delta / previous;
    factor_.solve_backward(beta, c_);
    const double curvature = remainder_.advance(beta, r_, c_, p_, q_);
    if (!(curvature > 0.0)) {
      is_indefinite = true;
      break;
    }
    const double alpha = delta / curvature;
    step_along(alpha, c_, q_, x, r_);
    is_true = false;
    previous = delta;
    delta = factor_.solve_forward(r_);
    ++result.iterations;
    if (coefficients) coefficients->alpha.push_back(alpha), coefficients->beta.push_back(delta / previous);
    if (observer) observer(done + result.iterations, std::sqrt(std::abs(delta)) / scale, x);
  }
  aim = limit;
  end_part();
  result.stop_value = std::sqrt(std::abs(delta)) / scale;
  if (!result.status.ok()) return result;
  if (!std::isfinite(delta)) {
    result.status = {Outcome::not_finite, fmt::format("the residual is not finite after {} iterations", result.iterations)};
  } else if (is_indefinite) {
    result.status = {
        Outcome::not_positive_definite,
        fmt::format("a search direction of curvature <= 0 after {} iterations: the matrix is not positive definite", result.iterations)};
  } else if (result.stop_value > options_.tolerance) {
    result.status = {Outcome::max_iterations,
                     fmt::format("{} iterations reach {:.3g}, not {:.3g}", result.iterations, result.stop_value, options_.tolerance)};
  }
  return result;
}

void CoreFast::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  const BlockCsr& a = *system.matrix;
  Timer timer;
  if (!analyze_if_new(system, summary)) return initial_guess(system, x);
  summary.order_ms = timer.lap();
  for (auto* v : {&load_, &r_, &c_, &p_, &q_}) v->resize(x.size());
  load_without_prescribed(system, load_);
  summary.reduce_ms = timer.lap();

  start(system, x);
  summary.solve_ms = timer.lap();
  // First: it reads A from end to end, for the factorisation, which does so in another order.
  remainder_.update(a);
  const bool in_single = factorize(CholeskyPrecision::single_precision, system, summary);
  if (!in_single && !begin_in_double(system, summary)) return;
  summary.factor_ms = timer.lap();

  const int limit = iteration_limit(a.dofs());
  KrylovResult result;
  bound_iterations_ = 0;
  if (delta0_ == 0.0) {
    LinearSystem from_rest = system;
    from_rest.guess = {};
    initial_guess(from_rest, x);
  } else {
    result = iterate(system, x, 0, limit, in_single);
  }
  summary.solve_ms += timer.lap();
  const int done = result.iterations;
  if (in_single && !result.status.ok() && done < limit) {
    const KrylovResult first = result;
    summary.status = first.status;
    if (!all_finite(x)) initial_guess(system, x);
    residual(system, x);
    starts_at_rest_ = false;
    if (!begin_in_double(system, summary)) return;
    summary.factor_ms += timer.lap();
    result = iterate(system, x, done, limit - done, false);
    result.iterations += done;
    result.start_value = first.start_value;
    summary.solve_ms += timer.lap();
  }
  take_over(result, summary);
  if (system.rho >= 0.0) summary.bound_iterations = bound_iterations_;
  summary.factor_nonzeros = factor_.statistics().nonzeros;
  summary.factor_flops = factor_.statistics().flops;
  summary.left_out_nonzeros = static_cast<double>(remainder_.nonzeros());
  summary.memory_bytes = factor_.statistics().bytes + static_cast<double>(remainder_.bytes()) + 5.0 * sizeof(double) * static_cast<double>(x.size());
}

}  // namespace taut
