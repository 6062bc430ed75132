#include "taut/solve/mpcg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/timer.h"
#include "taut/constraint/reduction.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

namespace {

// v := S v, visiting constrained nodes only.
class FreeProjection {
 public:
  explicit FreeProjection(const ConstraintSet* constraints) {
    if (!constraints) return;
    for (Index i = 0; i < constraints->nodes(); ++i)
      if (constraints->ndof(i) < 3) nodes_.push_back({i, constraints->projection(i)});
  }
  void apply(std::span<double> v) const {
    for (const auto& [i, s] : nodes_) {
      Eigen::Map<Vec3> node(&v[3 * static_cast<std::size_t>(i)]);
      node = s * Vec3(node);
    }
  }

 private:
  std::vector<std::pair<Index, Mat3>> nodes_;
};

}  // namespace

void Mpcg::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  const BlockCsr& a = *system.matrix;
  const std::size_t n = x.size();
  for (auto* v : {&r_, &s_, &c_, &q_}) v->resize(n);
  const FreeProjection free(system.constraints);
  const BlockCsr& source = source_.full(system, choice_.source);
  summary.reduce_ms = timer.lap();
  if (!m_ || !options_.reuse_analysis) m_ = choice_.make(options_, nullptr);
  if (choice_.wants_near_null_space) m_->set_near_null_space(near_null_space(system, false));
  const Preconditioner& m = *m_;
  summary.status = m_->update(source);
  summary.remark = m.remark();
  summary.memory_bytes =
      4.0 * sizeof(double) * n + static_cast<double>(source_.bytes() + m.bytes());
  initial_guess(system, x);
  summary.factor_ms = timer.lap();
  if (!summary.status.ok()) return;

  // δ0 from the driving right-hand side b̂, so that it does not depend on the guess.
  std::vector<double>& b_hat = q_;
  if (system.constraints) {
    s_.assign(system.z.begin(), system.z.end());
    project_constrained(system.constraints, s_);
    multiply(a, s_, b_hat);
    residual_from_product(system.rhs, b_hat);
    free.apply(b_hat);
  } else {
    b_hat.assign(system.rhs.begin(), system.rhs.end());
  }
  m.apply(b_hat, s_);
  const double delta0 = dot(b_hat, s_);
  if (delta0 == 0.0) {
    // Nothing drives the system: x = (I-S) z, and no guess can be improved on relative to nothing.
    LinearSystem undriven = system;
    undriven.guess = {};
    return initial_guess(undriven, x);
  }

  multiply(a, x, r_);
  residual_from_product(system.rhs, r_);
  free.apply(r_);
  m.apply(r_, c_);
  free.apply(c_);
  double delta = dot(r_, c_);
  const double limit = options_.tolerance * options_.tolerance * delta0;
  const int max_iterations = iteration_limit(static_cast<Index>(n));
  const auto relative = [&](double d) { return std::sqrt(std::abs(d / delta0)); };
  summary.start_value = relative(delta);

  double curvature = 1.0;
  while (delta > limit && summary.iterations < max_iterations) {
    curvature = multiply_dot(a, c_, q_);  // cᵀAc = cᵀSAc, since c = S c
    if (!(curvature > 0.0)) break;
    free.apply(q_);
    const double alpha = delta / curvature;
    add_scaled(alpha, c_, x);
    add_scaled(-alpha, q_, r_);
    m.apply(r_, s_);
    const double previous = delta;
    delta = dot(r_, s_);
    scale_add(delta / previous, s_, c_);
    free.apply(c_);
    ++summary.iterations;
    if (observer) observer(summary.iterations, relative(delta), x);
    if (!std::isfinite(delta)) break;
  }
  summary.stop_value = relative(delta);
  summary.solve_ms = timer.lap();
  if (!std::isfinite(delta) || !std::isfinite(delta0)) {
    summary.status = {
        Outcome::not_finite,
        fmt::format("the residual is not finite after {} iterations", summary.iterations)};
  } else if (delta < 0.0 || delta0 < 0.0) {
    summary.status = {Outcome::not_positive_definite,
                      fmt::format("rᵀ M⁻¹ r = {:.3g} < 0 after {} iterations: the preconditioner "
                                  "is not positive definite",
                                  std::min(delta, delta0), summary.iterations)};
  } else if (!(curvature > 0.0)) {
    summary.status = {Outcome::not_positive_definite,
                      fmt::format("a search direction of curvature {:.3g} after {} iterations",
                                  curvature, summary.iterations)};
  } else if (delta > limit) {
    summary.status = {Outcome::max_iterations,
                      fmt::format("{} iterations reach {:.3g}, not {:.3g}", summary.iterations,
                                  summary.stop_value, options_.tolerance)};
  }
}

}  // namespace taut
