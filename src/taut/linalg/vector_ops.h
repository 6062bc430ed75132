#pragma once
// Vector operations of the Krylov methods, parallel, with sums in a fixed order (same bits for any
// thread count). Sizes must agree (asserted).

#include <span>

#include "taut/base/types.h"

namespace taut {

double dot(std::span<const double> a, std::span<const double> b);
double norm(std::span<const double> a);
// y += alpha x
void add_scaled(double alpha, std::span<const double> x, std::span<double> y);
// y = x + beta y
void scale_add(double beta, std::span<const double> x, std::span<double> y);
// z = s r, entry by entry
void multiply_each(std::span<const double> s, std::span<const double> r, std::span<double> z);
// r = b - r   (turns a product A x into a residual)
void residual_from_product(std::span<const double> b, std::span<double> r);
// max |a_i|, 0 for none; NaN counts as 0.
double largest_magnitude(std::span<const double> a);
// y += alpha p,  r -= alpha q: conjugate gradients' step, in one pass. Returns
//                largest_magnitude(r).
double step_along(double alpha, std::span<const double> p, std::span<const double> q,
                  std::span<double> y, std::span<double> r);
// y = x
void copy(std::span<const double> x, std::span<double> y);
void set_zero(std::span<double> y);
// True when no entry is NaN or infinite.
bool all_finite(std::span<const double> a);

}  // namespace taut
