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
  return tolerance > 0.0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(tolerance) - 1e-9)), 1, 15) : 15;
}

}  // namespace

PardisoCgs::PardisoCgs(SolverOptions options) : ConstrainedSolver(std::move(options)), factor_(std::make_unique<PardisoFactor>()) {}
PardisoCgs::~PardisoCgs() = default;

void PardisoCgs::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  const bool had_factor = factorized_, new_pattern = reduced_.update(system);
  ++systems_;
  summary.reduce_ms = timer.lap();
  // NaN goes to the factorisation, which reports it.
  if (factorized_ && !new_pattern && all_finite(reduced_.matrix().values)) {
    solve_by_cg(summary);
  } else {
    if (had_factor)
      summary.remark = new_pattern ? "factorised anew: the matrix has another pattern" : "factorised anew: the matrix is not finite";
    factorize_and_solve(new_pattern || !analyzed_ || !options_.reuse_analysis, summary);
  }
  if (!summary.status.ok()) return initial_guess(system, x);
  reduced_.prolong_to(system, x);
  summary.memory_bytes = static_cast<double>(reduced_.matrix().bytes()) + factor_->statistics().bytes;
}

void PardisoCgs::solve_by_cg(SolveSummary& summary) {
  Timer timer;
  CgReport cg;
  summary.status = factor_->solve_by_cg(reduced_.matrix(), digits_for(options_.tolerance), reduced_.rhs(), reduced_.solution(), cg);
  summary.solve_ms = timer.lap();
  summary.iterations = cg.iterations;
  summary.fell_back = cg.gave_up != nullptr;
  fallbacks_ += summary.fell_back;
  if (summary.fell_back)
    summary.remark = fmt::format("factorised anew: CG on the kept factor gave up after {} iterations, {} (fall-back {} in {} systems)",
                                 cg.iterations, cg.gave_up, fallbacks_, systems_);
  factorized_ = summary.status.ok();
}

void PardisoCgs::factorize_and_solve(bool analyze, SolveSummary& summary) {
  Timer timer;
  factorized_ = false;
  if (analyze) {
    summary.status = factor_->analyze(reduced_.matrix());
    analyzed_ = summary.status.ok();
  }
  summary.order_ms = timer.lap();
  if (summary.status.ok()) summary.status = factor_->factorize(reduced_.matrix());
  summary.factor_ms = timer.lap();
  if (!summary.status.ok()) return;
  factorized_ = true;
  summary.status = factor_->solve(reduced_.rhs(), reduced_.solution());
  summary.solve_ms = timer.lap();
}

}  // namespace taut
