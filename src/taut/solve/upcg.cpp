#include "taut/solve/upcg.h"

#include "taut/base/timer.h"
#include "taut/solve/reduced_pcg.h"

namespace taut {

void Upcg::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  reduced_.update(system);
  const BlockCsr& source = source_.reduced(system, choice_.source, reduced_.matrix());
  summary.reduce_ms = timer.lap();
  // Those made from the constraints know nothing that could be kept.
  if (!m_ || !options_.reuse_analysis || choice_.source == PreconditionerSource::unconstrained)
    m_ = choice_.make(options_, system.constraints);
  if (choice_.wants_near_null_space) m_->set_near_null_space(near_null_space(system, true));
  summary.status = m_->update(source);
  summary.remark = m_->remark();
  summary.preparations = m_->preparations();
  summary.factor_ms = timer.lap();
  summary.memory_bytes =
      static_cast<double>(reduced_.matrix().bytes() + source_.bytes() + m_->bytes()) +
      6.0 * sizeof(double) * reduced_.rhs().size();
  if (!summary.status.ok()) return initial_guess(system, x);
  reduced_pcg(system, reduced_, *m_, options_.tolerance, iteration_limit(reduced_.matrix().dofs()),
              observer, x, summary, coefficients);
  summary.solve_ms = timer.lap();
}

}  // namespace taut
