#include "taut/solve/ppcg.h"

#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/constraint/reduction.h"
#include "taut/linalg/pcg.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/node_scale.h"
#include "taut/solve/reduced_pcg.h"

namespace taut {

void filter_matrix(const BlockCsr& a, const ConstraintSet* constraints, BlockCsr& filtered) {
  filtered = a;
  if (!constraints) return;
  const BlockPattern& p = *a.pattern;
  const std::vector<double> scale = node_scale(a);
  using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  parallel_for(p.rows(), 256, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
        const Index j = p.column[k];
        if (constraints->ndof(i) == 3 && constraints->ndof(j) == 3) continue;
        Eigen::Map<RowMajor3, 0, Eigen::OuterStride<>> block(filtered.block(i, k), Eigen::OuterStride<>(p.width(i)));
        Mat3 value = constraints->projection(i) * block * constraints->projection(j);
        if (i == j) value += scale[i] * (Mat3::Identity() - constraints->projection(i));
        block = value;
      }
  });
}

void Ppcg::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  const std::size_t n = x.size();
  filter_matrix(*system.matrix, system.constraints, filtered_);
  std::vector<double> rhs(system.rhs.begin(), system.rhs.end()), prescribed(n, 0.0);
  if (system.constraints) {
    prescribed.assign(system.z.begin(), system.z.end());
    project_constrained(system.constraints, prescribed);
    multiply(*system.matrix, prescribed, rhs);
    residual_from_product(system.rhs, rhs);
    project_free(system.constraints, rhs);
  }
  summary.reduce_ms = timer.lap();
  BlockDiagonalPreconditioner m;
  summary.status = m.update(filtered_);
  summary.factor_ms = timer.lap();
  summary.memory_bytes = static_cast<double>(filtered_.bytes() + m.bytes()) + 6.0 * sizeof(double) * n;
  if (!summary.status.ok()) return initial_guess(system, x);

  std::vector<double> y(n, 0.0);
  if (!system.guess.empty()) y.assign(system.guess.begin(), system.guess.end());
  project_free(system.constraints, y);
  const auto assemble = [&](std::span<const double> part) {
    for (std::size_t i = 0; i < n; ++i) x[i] = part[i] + prescribed[i];
  };
  KrylovOptions options{options_.tolerance, iteration_limit(static_cast<Index>(n)), {}};
  if (observer)
    options.observer = [&](int iteration, double value, std::span<const double> part) {
      assemble(part);
      observer(iteration, value, x);
    };
  take_over(pcg(BlockCsrOperator(filtered_), m, rhs, y, options), summary);
  assemble(y);
  summary.solve_ms = timer.lap();
}

}  // namespace taut
