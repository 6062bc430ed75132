#include "taut/solve/eq10.h"

#include "taut/base/timer.h"
#include "taut/constraint/reduction.h"
#include "taut/linalg/bicgstab.h"
#include "taut/linalg/incomplete_lu.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/filtered_matrix.h"
#include "taut/solve/node_scale.h"
#include "taut/solve/reduced_pcg.h"

namespace taut {

namespace {

using Map3 = Eigen::Map<Vec3>;
using ConstMap3 = Eigen::Map<const Vec3>;

// y_i := S_i y_i + d_i (I - S_i) x_i at constrained nodes.
void blend(const ConstraintSet* constraints, std::span<const double> scale,
           std::span<const double> x, std::span<double> y) {
  if (!constraints) return;
  for (Index i = 0; i < constraints->nodes(); ++i) {
    if (constraints->ndof(i) == 3) continue;
    const std::size_t dof = 3 * static_cast<std::size_t>(i);
    Map3 node(&y[dof]);
    node = constraints->free_part(i, node) +
           scale[i] * constraints->constrained_part(i, ConstMap3(&x[dof]));
  }
}

class Eq10Operator : public LinearOperator {
 public:
  Eq10Operator(const LinearSystem& system, std::span<const double> scale)
      : system_(system), scale_(scale) {}
  Index size() const override { return system_.matrix->dofs(); }
  double multiply_dot(std::span<const double> x, std::span<double> y) const override {
    multiply(*system_.matrix, x, y);
    blend(system_.constraints, scale_, x, y);
    return dot(x, y);
  }

 private:
  const LinearSystem& system_;
  std::span<const double> scale_;
};

}  // namespace

void Eq10::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  Timer timer;
  const std::vector<double> scale = node_scale(*system.matrix);
  std::vector<double> rhs(system.rhs.begin(), system.rhs.end());
  blend(system.constraints, scale, system.z, rhs);
  const bool blocks = kind_ == Eq10Preconditioner::block_diagonal;
  if (!m_ || !options_.reuse_analysis)
    m_ = blocks ? std::unique_ptr<Preconditioner>(std::make_unique<BlockDiagonalPreconditioner>())
                : std::make_unique<BlockIncompleteLu>();
  // The diagonal blocks of the symmetric form: the best node-wise guess at the inverse of this one.
  blocks ? filter_matrix(*system.matrix, system.constraints, filtered_)
         : filter_rows(*system.matrix, system.constraints, filtered_);
  summary.reduce_ms = timer.lap();
  summary.status = m_->update(filtered_);
  // ILU(0) does not mind a matrix that is not positive definite; what the diagonal shows of that is
  // told all the same.
  if (!blocks && summary.status.ok())
    summary.status = BlockDiagonalPreconditioner().update(*system.matrix);
  initial_guess(system, x);
  summary.factor_ms = timer.lap();
  summary.memory_bytes =
      static_cast<double>(filtered_.bytes() + m_->bytes()) + 8.0 * sizeof(double) * x.size();
  if (!summary.status.ok()) return;
  const KrylovOptions options{options_.tolerance, iteration_limit(static_cast<Index>(x.size())),
                              observer};
  take_over(bicgstab(Eq10Operator(system, scale), *m_, rhs, x, options), summary);
  summary.solve_ms = timer.lap();
}

}  // namespace taut
