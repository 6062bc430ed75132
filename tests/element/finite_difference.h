#pragma once
// Derivatives by central differences of fourth order, error O(step⁴).

#include <algorithm>
#include <limits>

#include "taut/base/types.h"

namespace taut::test {

// ∂f/∂a of a function Vec3 -> double, by components.
template <class F>
Vec3 numeric_gradient(const F& f, const Vec3& a, double step) {
  Vec3 gradient;
  for (int c = 0; c < 3; ++c) {
    const Vec3 s = step * Vec3::Unit(c);
    gradient[c] = (8.0 * (f(a + s) - f(a - s)) - (f(a + 2.0 * s) - f(a - 2.0 * s))) / (12.0 * step);
  }
  return gradient;
}

// ∂f/∂a of a function Vec3 -> Vec3: column c is ∂f/∂a_c.
template <class F>
Mat3 numeric_jacobian(const F& f, const Vec3& a, double step) {
  Mat3 jacobian;
  for (int c = 0; c < 3; ++c) {
    const Vec3 s = step * Vec3::Unit(c);
    jacobian.col(c) =
        (8.0 * (f(a + s) - f(a - s)) - (f(a + 2.0 * s) - f(a - 2.0 * s))) / (12.0 * step);
  }
  return jacobian;
}

// The smallest difference between derivative(step) and `expected` over some steps below
// `largest_step`: a large one suffers from truncation, a small one from rounding.
template <class Derivative, class Value>
double least_error(const Derivative& derivative, const Value& expected, double largest_step) {
  double least = std::numeric_limits<double>::infinity();
  for (double step = largest_step; step > 1e-3 * largest_step; step *= 0.3)
    least = std::min(least, (derivative(step) - expected).norm());
  return least;
}

}  // namespace taut::test
