#include "taut/solve/reference.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "taut/base/parallel.h"
#include "taut/constraint/reduction.h"
#include "taut/linalg/sparse_cholesky.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/reduced_system.h"

namespace taut {

namespace {

constexpr int max_refinements = 20;

// r = b - A y, each entry summed in extended precision and rounded once: in double the residual of
// a good y is all rounding.
void extended_residual(const BlockCsr& a, std::span<const double> b, std::span<const double> y,
                       std::span<double> r) {
  const BlockPattern& p = *a.pattern;
  parallel_for(p.rows(), 512, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      for (Index row = 0; row < p.dim(i); ++row) {
        const Index dof = p.dof_start[i] + row;
        const double* value = a.values.data() + p.value_start[i] + Offset{row} * p.width(i);
        long double sum = b[dof];
        for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
          for (Index c = p.dof_start[p.column[k]]; c < p.dof_start[p.column[k] + 1]; ++c)
            sum -= static_cast<long double>(*value++) * y[c];
        r[dof] = static_cast<double>(sum);
      }
  });
}

double anorm(const BlockCsr& a, std::span<const double> y) {
  std::vector<double> product(y.size());
  return std::sqrt(std::max(0.0, multiply_dot(a, y, product)));
}

// Refines y in place.
Status refine(const BlockCsr& a, SparseCholesky& factor, std::span<const double> b,
              std::span<double> y, ReferenceReport& report) {
  std::vector<double> r(y.size()), d(y.size()), best(y.begin(), y.end());
  double last = INFINITY;
  for (int k = 0; k <= max_refinements; ++k) {
    extended_residual(a, b, y, r);
    if (Status status = factor.solve(r, d); !status.ok()) return status;
    const double error = std::sqrt(std::abs(dot(d, r)));
    if (!std::isfinite(error))
      return {Outcome::not_finite, "the reference solution holds NaN or infinity"};
    if (error < last) {
      std::ranges::copy(y, best.begin());
      report.refinements = k;
      report.error_estimate = error;
    }
    if (error == 0.0 || !(error < 0.5 * last)) break;
    last = error;
    add_scaled(1.0, d, y);
  }
  std::ranges::copy(best, y.begin());
  if (const double size = anorm(a, y); size > 0.0) report.error_estimate /= size;
  return {};
}

Status solve_reduced(ReducedSystem& reduced, ReferenceReport& report) {
  const BlockCsr& a = reduced.matrix();
  if (a.dofs() == 0) return {};
  if (!all_finite(reduced.rhs()))
    return {Outcome::not_finite, "the right-hand side holds NaN or infinity"};
  if (!all_finite(a.values)) return {Outcome::not_finite, "the matrix holds NaN or infinity"};
  std::unique_ptr<SparseCholesky> factor = make_cholesky("cholmod");
  if (!factor) factor = make_cholesky("eigen");
  report.backend = factor->name();
  Status status = factor->analyze(a);
  if (status.ok()) status = factor->factorize(a);
  if (status.ok()) status = factor->solve(reduced.rhs(), reduced.solution());
  return status.ok() ? refine(a, *factor, reduced.rhs(), reduced.solution(), report) : status;
}

}  // namespace

std::vector<double> reference_solution(const LinearSystem& system, ReferenceReport& report) {
  report = {};
  ReducedSystem reduced;
  reduced.update(system);
  report.status = solve_reduced(reduced, report);
  if (!report.status.ok()) return {};
  std::vector<double> x(system.rhs.size());
  reduced.prolong_to(system, x);
  return x;
}

std::vector<double> reference_solution(const LinearSystem& system) {
  ReferenceReport report;
  return reference_solution(system, report);
}

double anorm_error(const LinearSystem& system, std::span<const double> x,
                   std::span<const double> x_reference) {
  assert(x.size() == x_reference.size() && static_cast<Index>(x.size()) == system.matrix->dofs());
  std::vector<double> error(x.begin(), x.end()), size(x_reference.begin(), x_reference.end());
  add_scaled(-1.0, x_reference, error);
  project_free(system.constraints, error);
  project_free(system.constraints, size);
  const double scale = anorm(*system.matrix, size);
  return scale > 0.0 ? anorm(*system.matrix, error) / scale : anorm(*system.matrix, error);
}

}  // namespace taut
