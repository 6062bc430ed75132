#include "taut/linalg/vector_ops.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"

namespace taut {

namespace {

// Entries per task: below this, handing over costs more than the work.
constexpr Index entries_per_task = 16384;

TAUT_MULTIVERSION double dot_kernel(const double* a, const double* b, Index n) {
  double s = 0.0;
#pragma omp simd reduction(+ : s)
  for (Index i = 0; i < n; ++i) s += a[i] * b[i];
  return s;
}

TAUT_MULTIVERSION void add_scaled_kernel(double alpha, const double* x, double* y, Index n) {
#pragma omp simd
  for (Index i = 0; i < n; ++i) y[i] += alpha * x[i];
}

TAUT_MULTIVERSION void scale_add_kernel(double beta, const double* x, double* y, Index n) {
#pragma omp simd
  for (Index i = 0; i < n; ++i) y[i] = x[i] + beta * y[i];
}

TAUT_MULTIVERSION void multiply_each_kernel(const double* s, const double* r, double* z, Index n) {
#pragma omp simd
  for (Index i = 0; i < n; ++i) z[i] = s[i] * r[i];
}

TAUT_MULTIVERSION double largest_kernel(const double* a, Index n) {
  double largest = 0.0;
#pragma omp simd reduction(max : largest)
  for (Index i = 0; i < n; ++i) {
    const double size = a[i] < 0.0 ? -a[i] : a[i];
    largest = size > largest ? size : largest;
  }
  return largest;
}

TAUT_MULTIVERSION double step_kernel(double alpha, const double* p, const double* q, double* y,
                                     double* r, Index n) {
  double largest = 0.0;
#pragma omp simd reduction(max : largest)
  for (Index i = 0; i < n; ++i) {
    y[i] += alpha * p[i];
    const double rest = r[i] - alpha * q[i], size = rest < 0.0 ? -rest : rest;
    r[i] = rest;
    largest = size > largest ? size : largest;
  }
  return largest;
}

// 0, or NaN if one of them is not finite.
TAUT_MULTIVERSION double nothing_of(const double* a, Index n) {
  double s = 0.0;
#pragma omp simd reduction(+ : s)
  for (Index i = 0; i < n; ++i) s += 0.0 * a[i];
  return s;
}

struct Largest {
  double value = 0.0;
  Largest& operator+=(const Largest& other) {
    value = value < other.value ? other.value : value;
    return *this;
  }
};

}  // namespace

double dot(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  return ordered_sum(static_cast<Index>(a.size()), [&](Index begin, Index end) {
    return dot_kernel(&a[begin], &b[begin], end - begin);
  });
}

double norm(std::span<const double> a) { return std::sqrt(dot(a, a)); }

void add_scaled(double alpha, std::span<const double> x, std::span<double> y) {
  assert(x.size() == y.size());
  parallel_for(static_cast<Index>(x.size()), entries_per_task, [&](Index begin, Index end) {
    add_scaled_kernel(alpha, &x[begin], &y[begin], end - begin);
  });
}

void scale_add(double beta, std::span<const double> x, std::span<double> y) {
  assert(x.size() == y.size());
  parallel_for(static_cast<Index>(x.size()), entries_per_task, [&](Index begin, Index end) {
    scale_add_kernel(beta, &x[begin], &y[begin], end - begin);
  });
}

void multiply_each(std::span<const double> s, std::span<const double> r, std::span<double> z) {
  assert(s.size() == r.size() && s.size() == z.size());
  parallel_for(static_cast<Index>(r.size()), entries_per_task, [&](Index begin, Index end) {
    multiply_each_kernel(&s[begin], &r[begin], &z[begin], end - begin);
  });
}

void residual_from_product(std::span<const double> b, std::span<double> r) {
  assert(b.size() == r.size());
  parallel_for(static_cast<Index>(b.size()), entries_per_task, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) r[i] = b[i] - r[i];
  });
}

double largest_magnitude(std::span<const double> a) {
  return ordered_sum<Largest>(static_cast<Index>(a.size()),
                              [&](Index begin, Index end) {
                                return Largest{largest_kernel(&a[begin], end - begin)};
                              })
      .value;
}

double step_along(double alpha, std::span<const double> p, std::span<const double> q,
                  std::span<double> y, std::span<double> r) {
  assert(p.size() == q.size() && p.size() == y.size() && p.size() == r.size());
  return ordered_sum<Largest>(static_cast<Index>(p.size()),
                              [&](Index begin, Index end) {
                                return Largest{step_kernel(alpha, &p[begin], &q[begin], &y[begin],
                                                           &r[begin], end - begin)};
                              })
      .value;
}

void copy(std::span<const double> x, std::span<double> y) {
  assert(x.size() == y.size());
  parallel_for(static_cast<Index>(x.size()), entries_per_task, [&](Index begin, Index end) {
    std::copy(x.begin() + begin, x.begin() + end, y.begin() + begin);
  });
}

void set_zero(std::span<double> y) {
  parallel_for(static_cast<Index>(y.size()), entries_per_task,
               [&](Index begin, Index end) { std::fill(y.begin() + begin, y.begin() + end, 0.0); });
}

bool all_finite(std::span<const double> a) {
  return ordered_sum(static_cast<Index>(a.size()), [&](Index begin, Index end) {
           return nothing_of(&a[begin], end - begin);
         }) == 0.0;
}

}  // namespace taut
