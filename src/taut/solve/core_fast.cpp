#include "taut/solve/core_fast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/core_bound.h"
#include "taut/solve/full_space.h"
#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/reduced_pcg.h"

namespace taut {

namespace {

// The factor in single precision is looked at when convergence is slow, and taken for bad when it misjudges a direction's energy by this
// share: then its rounding, not the springs outside the core, sets the number of iterations.
constexpr int check_every = 8;
constexpr double worst_quality = 0.3;

// y = P x: the blocks of the mask.
void multiply_masked(const BlockCsr& a, std::span<const std::uint8_t> mask, std::span<const double> x, std::span<double> y) {
  const BlockPattern& p = *a.pattern;
  parallel_for(p.rows(), 256, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index rows = p.dim(i), width = p.width(i);
      for (Index r = 0; r < rows; ++r) y[p.dof_start[i] + r] = 0.0;
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
        if (!mask[k] && p.column[k] != i) continue;
        const double* block = a.block(i, k);
        for (Index r = 0; r < rows; ++r)
          for (Index c = 0; c < p.dim(p.column[k]); ++c) y[p.dof_start[i] + r] += block[r * width + c] * x[p.column_dof[k] + c];
      }
    }
  });
}

}  // namespace

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

// For the search direction c and w = P c: wᵀ P̃⁻¹ w / cᵀ w, which is 1 but for the factor's rounding. Takes q_ for w.
double CoreFast::factor_quality(const BlockCsr& a) {
  multiply_masked(a, mask_, c_, q_);
  const double energy = dot(c_, q_);
  return factor_.solve_forward(q_) / energy;
}

// r_ for the start x. At rest, x = (I-S) z, it is the load.
void CoreFast::residual(const LinearSystem& system, std::span<const double> x) {
  starts_at_rest_ = false;
  multiply_dot(*system.matrix, x, r_);
  residual_from_product(system.rhs, r_);
}

// Conjugate gradients for the residual in r_, whose forward solve came with the factorisation, from x on; `done` iterations came before.
KrylovResult CoreFast::iterate(const BlockCsr& a, std::span<double> x, int done, int max_iterations, bool watch_factor) {
  KrylovResult result;
  const double limit = options_.tolerance * options_.tolerance * delta0_;
  const auto relative = [&](double d) { return std::sqrt(std::abs(d / delta0_)); };
  double delta = delta_, previous = 0.0;
  result.start_value = relative(delta);
  bool is_indefinite = false;
  if (coefficients) *coefficients = {};
  while (delta > limit && result.iterations < max_iterations) {
    factor_.solve_backward(result.iterations == 0 ? 0.0 : delta / previous, c_);
    const double curvature = multiply_dot(a, c_, q_);
    if (!(curvature > 0.0)) {
      is_indefinite = true;
      break;
    }
    const double alpha = delta / curvature;
    step_along(alpha, c_, q_, x, r_);
    if (watch_factor && result.iterations % check_every == check_every - 1) {
      const double quality = factor_quality(a);
      if (!(std::abs(quality - 1.0) < worst_quality)) {
        result.iterations += 1;
        result.stop_value = relative(delta);
        result.status = {Outcome::breakdown,
                         fmt::format("after {} iterations the factor in single precision is wrong by {:.2g} along the search direction",
                                     result.iterations, quality - 1.0)};
        return result;
      }
    }
    previous = delta;
    delta = factor_.solve_forward(r_);
    ++result.iterations;
    if (coefficients) coefficients->alpha.push_back(alpha), coefficients->beta.push_back(delta / previous);
    if (observer) observer(done + result.iterations, relative(delta), x);
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

  if (system.guess.empty()) {
    starts_at_rest_ = true;
    std::ranges::copy(load_, r_.begin());
  } else {
    residual(system, x);
  }
  summary.solve_ms = timer.lap();
  const bool in_single = factorize(CholeskyPrecision::single_precision, system, summary);
  if (!in_single && !begin_in_double(system, summary)) return;
  summary.factor_ms = timer.lap();

  const int limit = iteration_limit(a.dofs());
  KrylovResult result;
  if (delta0_ == 0.0) {
    LinearSystem from_rest = system;
    from_rest.guess = {};
    initial_guess(from_rest, x);
  } else {
    result = iterate(a, x, 0, limit, in_single);
  }
  summary.solve_ms += timer.lap();
  const int done = result.iterations;
  if (in_single && !result.status.ok() && done < limit) {
    const KrylovResult first = result;
    summary.status = first.status;
    if (!all_finite(x)) initial_guess(system, x);
    residual(system, x);
    if (!begin_in_double(system, summary)) return;
    summary.factor_ms += timer.lap();
    result = iterate(a, x, done, limit - done, false);
    result.iterations += done;
    result.start_value = first.start_value;
    summary.solve_ms += timer.lap();
  }
  take_over(result, summary);
  if (system.rho >= 0.0) summary.bound_iterations = core_iteration_bound(system.rho, summary.start_value, options_.tolerance);
  summary.factor_nonzeros = factor_.statistics().nonzeros;
  summary.factor_flops = factor_.statistics().flops;
  summary.memory_bytes = factor_.statistics().bytes + 4.0 * sizeof(double) * static_cast<double>(x.size());
}

}  // namespace taut
