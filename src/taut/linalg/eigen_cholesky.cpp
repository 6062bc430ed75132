#include "taut/linalg/eigen_cholesky.h"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>

namespace taut {

struct EigenCholesky::Implementation {
  using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;
  ScalarCsc csc;
  Eigen::SimplicialLDLT<Sparse, Eigen::Lower> factor;

  Eigen::Map<const Sparse> matrix() const {
    const Index n = static_cast<Index>(csc.column_start.size()) - 1;
    return {n,
            n,
            static_cast<Index>(csc.row.size()),
            csc.column_start.data(),
            csc.row.data(),
            csc.value.data()};
  }
};

EigenCholesky::EigenCholesky() : implementation_(std::make_unique<Implementation>()) {}
EigenCholesky::~EigenCholesky() = default;

Status EigenCholesky::analyze(const BlockCsr& a) {
  lower_triangle(a, implementation_->csc);
  implementation_->factor.analyzePattern(implementation_->matrix());
  // Eigen's permutation sends unknown i to place indices()[i]; ours says which unknown is k-th.
  const auto& to_place = implementation_->factor.permutationP().indices();
  permutation_.resize(static_cast<std::size_t>(to_place.size()));
  for (Index i = 0; i < static_cast<Index>(permutation_.size()); ++i) permutation_[to_place[i]] = i;
  return {};
}

Status EigenCholesky::factorize(const BlockCsr& a) {
  lower_triangle(a, implementation_->csc);
  implementation_->factor.factorize(implementation_->matrix());
  // L D Lᵀ also exists for indefinite matrices, so the pivots themselves are looked at.
  const auto pivots = implementation_->factor.vectorD();
  const bool complete = implementation_->factor.info() == Eigen::Success;
  for (Index k = 0; complete && k < static_cast<Index>(pivots.size()); ++k)
    if (!(pivots[k] > 0.0))
      return {
          Outcome::not_positive_definite,
          fmt::format(
              "Cholesky (eigen): pivot {:.3g} at unknown {}: the matrix is not positive definite",
              pivots[k], permutation_[k])};
  if (!complete)
    return {Outcome::not_positive_definite,
            "Cholesky (eigen): a zero pivot: the matrix is not positive definite"};
  return {};
}

Status EigenCholesky::solve(std::span<const double> b, std::span<double> x) {
  const Eigen::Map<const Eigen::VectorXd> rhs(b.data(), static_cast<Eigen::Index>(b.size()));
  Eigen::VectorXd solution = implementation_->factor.solve(rhs);
  std::copy(solution.data(), solution.data() + solution.size(), x.begin());
  return {};
}

FactorStatistics EigenCholesky::statistics() const {
  const double nonzeros =
      static_cast<double>(implementation_->factor.matrixL().nestedExpression().nonZeros());
  return {nonzeros, 0.0, nonzeros * (sizeof(double) + sizeof(Index)), "amd"};
}

}  // namespace taut
