#include "taut/solve/core_fast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/timer.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/full_space.h"
#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/reduced_pcg.h"

namespace taut {

bool CoreFast::analyze_if_new(const LinearSystem& system, SolveSummary& summary) {
  const bool is_known = pattern_ == system.matrix->pattern &&
                        (system.core.empty() ? std::ranges::equal(mask_, core_mask(system)) : std::ranges::equal(mask_, system.core));
  if (is_known) return true;
  mask_ = core_mask(system);
  pattern_ = system.matrix->pattern;
  factor_.set_precision(CholeskyPrecision::single_precision);
  summary.status = factor_.analyze(pattern_, mask_);
  if (!summary.status.ok()) pattern_ = nullptr;
  return summary.status.ok();
}

bool CoreFast::factorize(CholeskyPrecision precision, const LinearSystem& system, SolveSummary& summary) {
  factor_.set_precision(precision);
  summary.precision = precision == CholeskyPrecision::single_precision ? "single" : "double";
  summary.status = factor_.factorize(*system.matrix, free_basis(system), load_, &delta0_);
  if (summary.status.ok() && !std::isfinite(delta0_))
    summary.status = {Outcome::not_finite, "the right-hand side overflows the factor's precision"};
  return summary.status.ok();
}

bool CoreFast::begin_in_double(const LinearSystem& system, SolveSummary& summary) {
  summary.remark = fmt::format("double precision: {}", summary.status.message);
  ++summary.fallbacks;
  return factorize(CholeskyPrecision::double_precision, system, summary);
}

// Work of a factorisation in double precision (twice the time of its flops in single precision) over that of an iteration: two flops an
// entry of the factor each way and of A, which move four and eight bytes and so take about four times their share of the arithmetic's
// speed.
int CoreFast::single_precision_limit(const BlockCsr& a) const {
  const BlockCholeskyStatistics s = factor_.block_statistics();
  const double iteration = 16.0 * s.factor_entries + 16.0 * static_cast<double>(a.values.size());
  return 20 + static_cast<int>(2.0 * s.flops / std::max(1.0, iteration));
}

// Conjugate gradients for the residual in r_, from x on.
KrylovResult CoreFast::iterate(const BlockCsr& a, std::span<double> x, int max_iterations) {
  KrylovResult result;
  const double limit = options_.tolerance * options_.tolerance * delta0_;
  const auto relative = [&](double d) { return std::sqrt(std::abs(d / delta0_)); };
  double delta = factor_.solve_forward(r_), previous = 0.0;
  result.start_value = relative(delta);
  bool is_indefinite = false;
  while (delta > limit && result.iterations < max_iterations) {
    factor_.solve_backward(result.iterations == 0 ? 0.0 : delta / previous, c_);
    const double curvature = multiply_dot(a, c_, q_);
    if (!(curvature > 0.0)) {
      is_indefinite = true;
      break;
    }
    step_along(delta / curvature, c_, q_, x, r_);
    previous = delta;
    delta = factor_.solve_forward(r_);
    ++result.iterations;
    if (observer) observer(result.iterations, relative(delta), x);
  }
  result.stop_value = relative(delta);
  if (!std::isfinite(delta)) {
    result.status = {Outcome::not_finite, fmt::format("the residual is not finite after {} iterations", result.iterations)};
  } else if (is_indefinite) {
    result.status = {
        Outcome::not_positive_definite,
        fmt::format("a search direction of curvature <= 0 after {} iterations: the matrix is not positive definite", result.iterations)};
  } else if (delta > limit) {
    result.status = {Outcome::max_iterations,
                     fmt::format("{} iterations reach {:.3g}, not {:.3g}", result.iterations, result.stop_value, options_.tolerance)};
  }
  return result;
}

void CoreFast::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  const BlockCsr& a = *system.matrix;
  Timer timer;
  initial_guess(system, x);
  if (!analyze_if_new(system, summary)) return;
  summary.order_ms = timer.lap();
  for (auto* v : {&load_, &r_, &c_, &q_}) v->resize(x.size());
  load_without_prescribed(system, load_);
  summary.reduce_ms = timer.lap();

  const bool in_single = factorize(CholeskyPrecision::single_precision, system, summary);
  if (!in_single && !begin_in_double(system, summary)) return;
  summary.factor_ms = timer.lap();

  const int limit = iteration_limit(a.dofs());
  const auto residual = [&] {
    multiply_dot(a, x, r_);
    residual_from_product(system.rhs, r_);
  };
  residual();
  KrylovResult result;
  if (delta0_ == 0.0) {
    LinearSystem from_rest = system;
    from_rest.guess = {};
    initial_guess(from_rest, x);
  } else {
    result = iterate(a, x, in_single ? std::min(limit, single_precision_limit(a)) : limit);
  }
  summary.solve_ms = timer.lap();
  const int done = result.iterations;
  if (in_single && !result.status.ok() && done < limit) {
    const KrylovResult first = result;
    summary.status = first.status;
    if (!all_finite(x)) initial_guess(system, x);
    if (!begin_in_double(system, summary)) return;
    summary.factor_ms += timer.lap();
    residual();
    result = iterate(a, x, limit - done);
    result.iterations += done;
    result.start_value = first.start_value;
    summary.solve_ms += timer.lap();
  }
  take_over(result, summary);
  summary.memory_bytes = factor_.statistics().bytes + 4.0 * sizeof(double) * static_cast<double>(x.size());
}

}  // namespace taut
