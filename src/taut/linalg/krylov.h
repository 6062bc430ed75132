#pragma once
// What the Krylov methods share: the operator they see, their limits and their answer.

#include <functional>
#include <span>
#include <vector>

#include "taut/base/status.h"
#include "taut/base/types.h"

namespace taut {

// y = A x for a square A. `multiply_dot` also returns xᵀ y, which conjugate gradients need anyway.
class LinearOperator {
 public:
  virtual ~LinearOperator() = default;
  virtual Index size() const = 0;
  virtual double multiply_dot(std::span<const double> x, std::span<double> y) const = 0;
};

// What a run of conjugate gradients tells about the spectrum of M_p⁻¹ A (linalg/lanczos.h).
struct CgCoefficients {
  std::vector<double> alpha, beta;  // α_k = δ_k/(cᵀAc), β_k = δ_(k+1)/δ_k, one of each an iteration
};

struct KrylovOptions {
  double relative_tolerance = 1e-3;
  int max_iterations = 1000;
  // Called after every iteration with its number, the stop test's value sqrt(δ/δ0) and the iterate;
  // for histories. May be empty.
  std::function<void(int, double, std::span<const double>)> observer;
  // pcg: overwritten with the run's coefficients, unless null.
  CgCoefficients* coefficients = nullptr;
};

struct KrylovResult {
  Status status;
  int iterations = 0;
  double stop_value = 0.0;   // sqrt(δ/δ0) at the end: at most relative_tolerance when converged
  double start_value = 0.0;  // sqrt(δ/δ0) of the initial guess
};

}  // namespace taut
