#include "taut/solve/block_direct.h"

#include <cassert>

#include "taut/base/timer.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/full_space.h"

namespace taut {

namespace {

// Of badly conditioned matrices, whose first solution leaves more: then it is refined once.
constexpr double good_residual = 1e-11;

}  // namespace

void BlockDirect::refine(const LinearSystem& system, std::span<double> x) {
  if (!(relative_residual(system, x) > good_residual)) return;
  multiply(*system.matrix, x, load_);
  residual_from_product(system.rhs, load_);
  factor_.solve_forward(load_);
  factor_.solve_backward(0.0, free_part_);
  if (all_finite(free_part_)) add_scaled(1.0, free_part_, x);
}

void BlockDirect::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  const BlockCsr& a = *system.matrix;
  Timer timer;
  if (pattern_ != a.pattern) {
    pattern_ = nullptr;
    summary.status = factor_.analyze(a.pattern, {});
    if (!summary.status.ok()) return initial_guess(system, x);
    pattern_ = a.pattern;
  }
  summary.order_ms = timer.lap();
  load_.resize(x.size());
  free_part_.resize(x.size());
  load_without_prescribed(system, load_);
  summary.reduce_ms = timer.lap();
  summary.status = factor_.factorize(a, free_basis(system), load_);
  summary.factor_ms = timer.lap();
  if (!summary.status.ok()) return initial_guess(system, x);
  finish(system, x, summary);
}

void BlockDirect::run_again(const LinearSystem& system, std::span<double> x,
                            SolveSummary& summary) {
  assert(pattern_ == system.matrix->pattern);
  Timer timer;
  load_without_prescribed(system, load_);
  summary.reduce_ms = timer.lap();
  factor_.solve_forward(load_);
  const double forward_ms = timer.lap();
  finish(system, x, summary);
  summary.solve_ms += forward_ms;
}

// From the forward solve on.
void BlockDirect::finish(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  factor_.solve_backward(0.0, free_part_);
  LinearSystem from_rest = system;
  from_rest.guess = {};
  initial_guess(from_rest, x);
  add_scaled(1.0, free_part_, x);
  refine(system, x);
  summary.solve_ms = timer.lap();
  summary.factor_nonzeros = factor_.statistics().nonzeros;
  summary.factor_flops = factor_.statistics().flops;
  summary.memory_bytes =
      factor_.statistics().bytes + 2.0 * sizeof(double) * static_cast<double>(x.size());
}

}  // namespace taut
