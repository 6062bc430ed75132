#include "taut/linalg/bicgstab.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "taut/linalg/vector_ops.h"

namespace taut {

namespace {

constexpr int max_restarts = 20;

struct Run {
  const LinearOperator& a;
  const Preconditioner& m;
  std::span<const double> b;
  std::span<double> x;
  const KrylovOptions& options;
  double b_norm;
  KrylovResult& result;
  std::vector<double> r, shadow, p, v, t, p_hat, s_hat;

  double true_residual() {
    a.multiply_dot(x, r);
    residual_from_product(b, r);
    return norm(r) / b_norm;
  }

  // One cycle from the current x. True when the recurrence says converged or the limit is hit,
  // false on breakdown.
  bool cycle() {
    shadow = r;
    std::fill(p.begin(), p.end(), 0.0);
    std::fill(v.begin(), v.end(), 0.0);
    double rho = 1.0, alpha = 1.0, omega = 1.0;
    while (result.iterations < options.max_iterations) {
      const double next_rho = dot(shadow, r);
      // Relative to the vectors' sizes, this is where the shadow residual has become useless.
      if (!(std::abs(next_rho) > 1e-14 * norm(shadow) * norm(r))) return false;
      const double beta = next_rho / rho * (alpha / omega);
      rho = next_rho;
      add_scaled(-omega, v, p);
      scale_add(beta, r, p);
      m.apply(p, p_hat);
      a.multiply_dot(p_hat, v);
      alpha = rho / dot(shadow, v);
      if (!std::isfinite(alpha)) return false;
      add_scaled(alpha, p_hat, x);
      add_scaled(-alpha, v, r);
      m.apply(r, s_hat);
      a.multiply_dot(s_hat, t);
      const double tt = dot(t, t);
      omega = tt > 0.0 ? dot(t, r) / tt : 0.0;
      add_scaled(omega, s_hat, x);
      add_scaled(-omega, t, r);
      ++result.iterations;
      result.stop_value = norm(r) / b_norm;
      if (options.observer) options.observer(result.iterations, result.stop_value, x);
      if (!std::isfinite(result.stop_value)) return false;
      if (result.stop_value <= options.relative_tolerance) return true;
      if (omega == 0.0) return false;
    }
    return true;
  }
};

}  // namespace

KrylovResult bicgstab(const LinearOperator& a, const Preconditioner& m, std::span<const double> b,
                      std::span<double> x, const KrylovOptions& options) {
  const std::size_t n = static_cast<std::size_t>(a.size());
  assert(b.size() == n && x.size() == n);
  KrylovResult result;
  const double b_norm = norm(b);
  if (b_norm == 0.0) {
    std::fill(x.begin(), x.end(), 0.0);
    return result;
  }
  const std::vector<double> zero(n);
  Run run{a, m, b, x, options, b_norm, result, zero, zero, zero, zero, zero, zero, zero};
  result.start_value = result.stop_value = run.true_residual();
  // Written so that a NaN goes into the loop and is reported there.
  for (int restart = 0; !(result.stop_value <= options.relative_tolerance) &&
                        result.iterations < options.max_iterations;
       ++restart) {
    if (restart > max_restarts) {
      result.status = {
          Outcome::breakdown,
          fmt::format("BiCGSTAB broke down {} times; residual {:.3g} after {} iterations", restart,
                      result.stop_value, result.iterations)};
      return result;
    }
    run.cycle();
    result.stop_value = run.true_residual();
    if (!std::isfinite(result.stop_value)) {
      result.status = {
          Outcome::not_finite,
          fmt::format("the residual is not finite after {} iterations", result.iterations)};
      return result;
    }
  }
  if (!(result.stop_value <= options.relative_tolerance))
    result.status = {Outcome::max_iterations,
                     fmt::format("{} iterations reach {:.3g}, not {:.3g}", result.iterations,
                                 result.stop_value, options.relative_tolerance)};
  return result;
}

}  // namespace taut
