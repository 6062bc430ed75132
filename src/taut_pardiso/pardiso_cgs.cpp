#include "taut_pardiso/pardiso_cgs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pardiso_factor.h"
#include "taut/base/timer.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

namespace {

int digits_for(double tolerance) {
  // log10(1e-3) may come out a little off -3, which is not to cost a digit.
  return tolerance > 0.0
             ? std::clamp(static_cast<int>(std::ceil(-std::log10(tolerance) - 1e-9)), 1, 15)
             : 15;
}

}  // namespace

PardisoCgs::PardisoCgs(SolverOptions options)
    : ConstrainedSolver(std::move(options)), factor_(std::make_unique<PardisoFactor>()) {}
PardisoCgs::~PardisoCgs() = default;

void PardisoCgs::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  const bool new_pattern = reduced_.update(system), had_factor = has_factor_;
  ++systems_;
  summary.reduce_ms = timer.lap();
  if (new_pattern || !had_factor) {
    // A handle without a factor cannot but factorise.
    summary.status = factor_->analyze(reduced_.matrix());
    if (had_factor) summary.remark = "factorised anew: the matrix has another pattern";
    has_factor_ = false;
  }
  summary.order_ms = timer.lap();
  if (summary.status.ok()) solve_reduced(summary);
  if (!summary.status.ok()) return initial_guess(system, x);
  reduced_.prolong_to(system, x);
  summary.memory_bytes =
      static_cast<double>(reduced_.matrix().bytes()) + factor_->statistics().bytes;
}

void PardisoCgs::solve_reduced(SolveSummary& summary) {
  Timer timer;
  // Its CG divides by the norm of b, and may then never end.
  if (norm(reduced_.rhs()) == 0.0) {
    std::ranges::fill(reduced_.solution(), 0.0);
    return;
  }
  const bool had_factor = has_factor_;
  CgReport cg;
  // NaN is for the factorisation, which refuses it.
  summary.status = all_finite(reduced_.matrix().values)
                       ? factor_->solve_by_cg(reduced_.matrix(), digits_for(options_.tolerance),
                                              reduced_.rhs(), reduced_.solution(), cg)
                       : factor_->factorize(reduced_.matrix());
  has_factor_ = summary.status.ok();
  (cg.factorized ? summary.factor_ms : summary.solve_ms) = timer.lap();
  summary.iterations = cg.factorized ? 0 : cg.iterations;
  if (!cg.factorized || !had_factor) return;
  ++fallbacks_;
  summary.remark =
      fmt::format("factorised anew: CG on the kept factor gave up (fall-back {} in {} systems)",
                  fallbacks_, systems_);
}

}  // namespace taut
