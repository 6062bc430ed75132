#include "taut/solve/ppcg.h"

#include "taut/base/timer.h"
#include "taut/constraint/reduction.h"
#include "taut/linalg/pcg.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/filtered_matrix.h"
#include "taut/solve/reduced_pcg.h"

namespace taut {

namespace {

// S M_p⁻¹, on free directions symmetric like M_p⁻¹: of one that does not keep to them.
class FreePart : public Preconditioner {
 public:
  FreePart(const Preconditioner& m, const ConstraintSet* constraints)
      : m_(m), constraints_(constraints) {}
  Status update(const BlockCsr&) override { return {}; }
  void apply(std::span<const double> r, std::span<double> z) const override {
    m_.apply(r, z);
    project_free(constraints_, z);
  }

 private:
  const Preconditioner& m_;
  const ConstraintSet* constraints_;
};

}  // namespace

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
  // The diagonal blocks and the whole are read from the filtered matrix itself.
  const BlockCsr& source = choice_.source == PreconditionerSource::core
                               ? source_.full(system, choice_.source)
                               : filtered_;
  summary.reduce_ms = timer.lap();
  if (!m_ || !options_.reuse_analysis) m_ = choice_.make(options_, nullptr);
  if (choice_.wants_near_null_space) m_->set_near_null_space(near_null_space(system, false));
  summary.status = m_->update(source);
  summary.remark = m_->remark();
  summary.factor_ms = timer.lap();
  summary.memory_bytes = static_cast<double>(filtered_.bytes() + source_.bytes() + m_->bytes()) +
                         6.0 * sizeof(double) * n;
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
  const FreePart free_part(*m_, system.constraints);
  const Preconditioner& whole = *m_;
  const Preconditioner& m = choice_.keeps_free_directions ? whole : free_part;
  take_over(pcg(BlockCsrOperator(filtered_), m, rhs, y, options), summary);
  assemble(y);
  summary.solve_ms = timer.lap();
}

}  // namespace taut
