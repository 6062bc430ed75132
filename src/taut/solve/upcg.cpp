#include "taut/solve/upcg.h"

#include "taut/base/timer.h"
#include "taut/solve/reduced_pcg.h"

namespace taut {

namespace {

std::unique_ptr<Preconditioner> make_diagonal(UpcgDiagonal kind, const ConstraintSet* constraints) {
  switch (kind) {
    case UpcgDiagonal::scalar: return std::make_unique<ProjectedNodePreconditioner>(NodeDiagonal::scalar, constraints);
    case UpcgDiagonal::block: return std::make_unique<ProjectedNodePreconditioner>(NodeDiagonal::block, constraints);
    case UpcgDiagonal::reduced_scalar: return std::make_unique<DiagonalPreconditioner>();
    case UpcgDiagonal::reduced_block: break;
  }
  return std::make_unique<BlockDiagonalPreconditioner>();
}

}  // namespace

void Upcg::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  reduced_.update(system);
  summary.reduce_ms = timer.lap();
  const auto m = make_diagonal(kind_, system.constraints);
  const bool from_full = kind_ == UpcgDiagonal::scalar || kind_ == UpcgDiagonal::block;
  summary.status = m->update(from_full ? *system.matrix : reduced_.matrix());
  summary.factor_ms = timer.lap();
  summary.memory_bytes = static_cast<double>(reduced_.matrix().bytes() + m->bytes()) + 6.0 * sizeof(double) * reduced_.rhs().size();
  if (!summary.status.ok()) return initial_guess(system, x);
  reduced_pcg(system, reduced_, *m, options_.tolerance, iteration_limit(reduced_.matrix().dofs()), observer, x, summary);
  summary.solve_ms = timer.lap();
}

}  // namespace taut
