#include "taut/solve/reduced_pcg.h"

namespace taut {

void take_over(const KrylovResult& result, SolveSummary& summary) {
  summary.status = result.status;
  summary.iterations = result.iterations;
  summary.stop_value = result.stop_value;
  summary.start_value = result.start_value;
}

void reduced_pcg(const LinearSystem& system, ReducedSystem& reduced, const Preconditioner& m,
                 double tolerance, int max_iterations, const SolveObserver& observer,
                 std::span<double> x, SolveSummary& summary, CgCoefficients* coefficients) {
  KrylovOptions options{tolerance, max_iterations, {}, coefficients};
  if (observer)
    options.observer = [&](int iteration, double value, std::span<const double> y) {
      prolong(system.constraints, y, system.z, x);
      observer(iteration, value, x);
    };
  take_over(pcg(BlockCsrOperator(reduced.matrix()), m, reduced.rhs(), reduced.solution(), options),
            summary);
  reduced.prolong_to(system, x);
}

}  // namespace taut
