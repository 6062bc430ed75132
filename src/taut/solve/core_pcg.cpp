#include "taut/solve/core_pcg.h"

#include <cassert>

#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/core/core_bound.h"
#include "taut/linalg/factor_preconditioner.h"
#include "taut/solve/preconditioner_choice.h"
#include "taut/solve/reduced_pcg.h"

namespace taut {

namespace {

// Π A Πᵀ as a scalar matrix: row k is unknown perm[k]. Columns within a row stay in A's order,
// which products do not mind.
BlockCsr permuted(const BlockCsr& a, std::span<const Index> perm) {
  const BlockPattern& p = *a.pattern;
  const Index n = p.dofs();
  std::vector<Index> place(static_cast<std::size_t>(n)), node_of(static_cast<std::size_t>(n));
  for (Index k = 0; k < n; ++k) place[perm[k]] = k;
  for (Index i = 0; i < p.rows(); ++i)
    for (Index r = p.dof_start[i]; r < p.dof_start[i + 1]; ++r) node_of[r] = i;
  std::vector<Index> row_start(static_cast<std::size_t>(n) + 1, 0),
      dof_start(static_cast<std::size_t>(n) + 1);
  for (Index k = 0; k <= n; ++k) dof_start[k] = k;
  for (Index k = 0; k < n; ++k) row_start[k + 1] = row_start[k] + p.width(node_of[perm[k]]);
  std::vector<Index> column(static_cast<std::size_t>(row_start[n]));
  LargeVector<double> values(column.size());
  parallel_for(n, 2048, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      const Index i = node_of[perm[k]], r = perm[k] - p.dof_start[i];
      const double* row = a.values.data() + p.value_start[i] + Offset{r} * p.width(i);
      Index out = row_start[k];
      for (Index b = p.row_start[i]; b < p.row_start[i + 1]; ++b)
        for (Index dof = p.dof_start[p.column[b]]; dof < p.dof_start[p.column[b] + 1]; ++dof) {
          column[out] = place[dof];
          values[out++] = *row++;
        }
    }
  });
  BlockCsr result(make_pattern(std::move(row_start), std::move(column), std::move(dof_start)));
  result.values = std::move(values);
  return result;
}

}  // namespace

CorePcg::CorePcg(SolverOptions options, const std::string& backend)
    : ConstrainedSolver(std::move(options)) {
  cholesky_ = make_cholesky(backend.empty() ? "cholmod" : backend);
  if (!cholesky_ && backend.empty()) {
    cholesky_ = make_cholesky("eigen");
    remark_ = "core factorised by Eigen: CHOLMOD is not built in";
  }
  assert(cholesky_);
}

void CorePcg::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  summary.remark = remark_;
  reduced_.update(system);
  const bool new_pattern =
      core_.update(core_matrix(system, own_core_), system.constraints, core_mask(system));
  summary.core = system.core.name;
  summary.reduce_ms = timer.lap();

  if (new_pattern || !analyzed_ || !options_.reuse_analysis) {
    summary.status = cholesky_->analyze(core_.matrix());
    analyzed_ = summary.status.ok();
  }
  summary.order_ms = timer.lap();
  if (summary.status.ok()) summary.status = cholesky_->factorize(core_.matrix());
  summary.factor_ms = timer.lap();
  if (!summary.status.ok()) return initial_guess(system, x);

  if (options_.reordering == "matrix" && !cholesky_->permutation().empty()) {
    loop_in_factor_order(system, x, summary);
  } else {
    const FactorPreconditioner m(*cholesky_, false);
    reduced_pcg(system, reduced_, m, options_.tolerance, iteration_limit(reduced_.matrix().dofs()),
                observer, x, summary, coefficients);
  }
  summary.solve_ms = timer.lap();
  summary.condition = system.core.condition();
  if (summary.condition > 0.0)
    summary.bound_iterations =
        iteration_bound(summary.condition, summary.start_value, options_.tolerance);
  summary.factor_nonzeros = cholesky_->statistics().nonzeros;
  summary.factor_flops = cholesky_->statistics().flops;
  summary.memory_bytes = static_cast<double>(reduced_.matrix().bytes() + core_.matrix().bytes()) +
                         cholesky_->statistics().bytes;
}

void CorePcg::loop_in_factor_order(const LinearSystem& system, std::span<double> x,
                                   SolveSummary& summary) {
  const auto perm = cholesky_->permutation();
  const std::size_t n = perm.size();
  const BlockCsr a = permuted(reduced_.matrix(), perm);
  std::vector<double> b(n), y(n);
  const auto scatter = [&](std::span<const double> ordered) {
    for (std::size_t k = 0; k < n; ++k) reduced_.solution()[perm[k]] = ordered[k];
    reduced_.prolong_to(system, x);
  };
  for (std::size_t k = 0; k < n; ++k)
    b[k] = reduced_.rhs()[perm[k]], y[k] = reduced_.solution()[perm[k]];
  KrylovOptions options{
      options_.tolerance, iteration_limit(static_cast<Index>(n)), {}, coefficients};
  if (observer)
    options.observer = [&](int iteration, double value, std::span<const double> ordered) {
      scatter(ordered);
      observer(iteration, value, x);
    };
  take_over(pcg(BlockCsrOperator(a), FactorPreconditioner(*cholesky_, true), b, y, options),
            summary);
  scatter(y);
}

}  // namespace taut
