#include "taut/linalg/pcg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "taut/linalg/vector_ops.h"

namespace taut {

KrylovResult pcg(const LinearOperator& a, const Preconditioner& m, std::span<const double> b,
                 std::span<double> x, const KrylovOptions& options) {
  const std::size_t n = static_cast<std::size_t>(a.size());
  assert(b.size() == n && x.size() == n);
  KrylovResult result;
  std::vector<double> r(n), s(n), c(n), q(n);
  if (options.coefficients) *options.coefficients = {};

  m.apply(b, s);
  const double delta0 = dot(b, s);
  if (delta0 == 0.0) {
    std::fill(x.begin(), x.end(), 0.0);
    return result;
  }
  a.multiply_dot(x, r);
  residual_from_product(b, r);
  m.apply(r, c);
  double delta = dot(r, c);
  const double limit = options.relative_tolerance * options.relative_tolerance * delta0;
  const auto relative = [&](double d) { return std::sqrt(std::abs(d / delta0)); };
  result.start_value = relative(delta);

  while (delta > limit && result.iterations < options.max_iterations) {
    const double curvature = a.multiply_dot(c, q);
    if (!(curvature > 0.0)) break;
    const double alpha = delta / curvature;
    add_scaled(alpha, c, x);
    add_scaled(-alpha, q, r);
    m.apply(r, s);
    const double previous = delta;
    delta = dot(r, s);
    scale_add(delta / previous, s, c);
    ++result.iterations;
    if (options.coefficients)
      options.coefficients->alpha.push_back(alpha),
          options.coefficients->beta.push_back(delta / previous);
    if (options.observer) options.observer(result.iterations, relative(delta), x);
    if (!std::isfinite(delta)) break;
  }

  result.stop_value = relative(delta);
  if (!std::isfinite(delta) || !std::isfinite(delta0)) {
    result.status = {
        Outcome::not_finite,
        fmt::format("the residual is not finite after {} iterations", result.iterations)};
  } else if (delta < 0.0 || delta0 < 0.0) {
    result.status = {Outcome::not_positive_definite,
                     fmt::format("rᵀ M⁻¹ r = {:.3g} < 0 after {} iterations: the preconditioner is "
                                 "not positive definite",
                                 std::min(delta, delta0), result.iterations)};
  } else if (delta > limit && result.iterations < options.max_iterations) {
    result.status = {Outcome::not_positive_definite,
                     fmt::format("a search direction of curvature <= 0 after {} iterations: the "
                                 "matrix is not positive definite",
                                 result.iterations)};
  } else if (delta > limit) {
    result.status = {Outcome::max_iterations,
                     fmt::format("{} iterations reach {:.3g}, not {:.3g}", result.iterations,
                                 result.stop_value, options.relative_tolerance)};
  }
  return result;
}

}  // namespace taut
