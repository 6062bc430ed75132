// A solver and a preconditioner as a user's program would bring them, registered before the tests
// are listed: what is tested of all solvers is tested of "own", "mpcg:own", "upcg:own", "ppcg:own".

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <cmath>

#include "taut/solve/solver_registry.h"

namespace taut::test {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Entries = std::vector<Eigen::Triplet<double>>;

// (S A S + I - S) y = S (b - A (I-S) z),  x = y + (I-S) z,  by Eigen's sparse L D Lᵀ.
class OwnSolver : public ConstrainedSolver {
 public:
  explicit OwnSolver(SolverOptions options) : ConstrainedSolver(std::move(options)) {}

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override {
    const Sparse a = matrix(*system.matrix), s = projection(system);
    Sparse held(a.rows(), a.cols());
    held.setIdentity();
    held -= s;
    const auto vector = [](std::span<const double> v) {
      return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
    };
    Eigen::VectorXd prescribed = Eigen::VectorXd::Zero(a.rows());
    if (system.constraints) prescribed = held * vector(system.z);
    const Sparse filtered = s * a * s + held;
    const Eigen::SimplicialLDLT<Sparse> factor(filtered);
    if (factor.info() != Eigen::Success ||
        !(factor.vectorD().array() > 0.0 && factor.vectorD().array().isFinite()).all()) {
      summary.status = {Outcome::not_positive_definite, "own: a pivot is not positive"};
      return initial_guess(system, x);
    }
    const Eigen::VectorXd load = s * (vector(system.rhs) - a * prescribed);
    Eigen::Map<Eigen::VectorXd>(x.data(), a.rows()) = factor.solve(load) + prescribed;
  }

 private:
  static Sparse matrix(const BlockCsr& a) {
    const BlockPattern& p = *a.pattern;
    Entries entries;
    for (Index i = 0; i < p.rows(); ++i)
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
        for (Index r = 0; r < p.dim(i); ++r)
          for (Index c = 0; c < p.dim(p.column[k]); ++c)
            entries.emplace_back(p.dof_start[i] + r, p.dof_start[p.column[k]] + c,
                                 a.block(i, k)[r * p.width(i) + c]);
    return sparse(a.dofs(), entries);
  }
  static Sparse projection(const LinearSystem& system) {
    const Index n = system.matrix->dofs();
    Entries entries;
    for (Index dof = 0; dof < n && !system.constraints; ++dof) entries.emplace_back(dof, dof, 1.0);
    for (Index i = 0; system.constraints && i < system.constraints->nodes(); ++i)
      for (Index r = 0; r < 3; ++r)
        for (Index c = 0; c < 3; ++c)
          entries.emplace_back(3 * i + r, 3 * i + c, system.constraints->projection(i)(r, c));
    return sparse(n, entries);
  }
  static Sparse sparse(Index n, const Entries& entries) {
    Sparse result(n, n);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
  }
};

// The diagonal blocks of whatever it is given.
class OwnPreconditioner : public Preconditioner {
 public:
  Status update(const BlockCsr& a) override {
    pattern_ = a.pattern;
    const BlockPattern& p = *pattern_;
    inverse_.clear();
    for (Index i = 0; i < p.rows(); ++i) {
      Eigen::MatrixXd block(p.dim(i), p.dim(i));
      for (Index r = 0; r < p.dim(i); ++r)
        for (Index c = 0; c < p.dim(i); ++c)
          block(r, c) = a.block(i, p.diagonal[i])[r * p.width(i) + c];
      const Eigen::LLT<Eigen::MatrixXd> factor(block);
      if (!block.allFinite()) return {Outcome::not_finite, "own: a block is not finite"};
      if (factor.info() != Eigen::Success)
        return {Outcome::not_positive_definite, "own: a block is not positive definite"};
      inverse_.push_back(factor.solve(Eigen::MatrixXd::Identity(p.dim(i), p.dim(i))));
    }
    return {};
  }
  void apply(std::span<const double> r, std::span<double> z) const override {
    for (Index i = 0; i < pattern_->rows(); ++i) {
      const Index dof = pattern_->dof_start[i], dim = pattern_->dim(i);
      Eigen::Map<Eigen::VectorXd>(z.data() + dof, dim).noalias() =
          inverse_[i] * Eigen::Map<const Eigen::VectorXd>(r.data() + dof, dim);
    }
  }

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<Eigen::MatrixXd> inverse_;
};

[[maybe_unused]] const bool registered = [] {
  register_solver("own", [](const SolverOptions& o) { return std::make_unique<OwnSolver>(o); },
                  {.is_direct = true});
  register_preconditioner(
      "own", [](const SolverOptions&) { return std::make_unique<OwnPreconditioner>(); });
  return true;
}();

}  // namespace
}  // namespace taut::test
