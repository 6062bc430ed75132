#include "taut/solve/direct.h"

#include <cassert>

#include "taut/base/timer.h"

namespace taut {

Direct::Direct(SolverOptions options, const std::string& backend, AnalysisUse analysis)
    : ConstrainedSolver(std::move(options)), cholesky_(make_cholesky(backend)) {
  assert(cholesky_);
  if (analysis == AnalysisUse::kept) options_.reuse_analysis = true;
}

void Direct::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  const bool new_pattern = reduced_.update(system);
  summary.reduce_ms = timer.lap();
  if (new_pattern || !analyzed_ || !options_.reuse_analysis) {
    summary.status = cholesky_->analyze(reduced_.matrix());
    analyzed_ = summary.status.ok();
  }
  summary.order_ms = timer.lap();
  if (summary.status.ok()) summary.status = cholesky_->factorize(reduced_.matrix());
  summary.factor_ms = timer.lap();
  if (!summary.status.ok()) return initial_guess(system, x);
  solve_with_factor(system, x, summary);
}

void Direct::run_again(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  reduced_.update_load(system);
  summary.reduce_ms = timer.lap();
  solve_with_factor(system, x, summary);
}

void Direct::solve_with_factor(const LinearSystem& system, std::span<double> x,
                               SolveSummary& summary) {
  Timer timer;
  summary.status = cholesky_->solve(reduced_.rhs(), reduced_.solution());
  reduced_.prolong_to(system, x);
  summary.solve_ms = timer.lap();
  summary.factor_nonzeros = cholesky_->statistics().nonzeros;
  summary.factor_flops = cholesky_->statistics().flops;
  summary.memory_bytes =
      static_cast<double>(reduced_.matrix().bytes()) + cholesky_->statistics().bytes;
}

}  // namespace taut
