#include "taut/linalg/eigen_cholesky.h"

#include <Eigen/SparseCholesky>

namespace taut {

struct EigenCholesky::Implementation {
  using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;
  ScalarCsc csc;
  Eigen::SimplicialLLT<Sparse, Eigen::Lower> factor;

  Eigen::Map<const Sparse> matrix() const {
    const Index n = static_cast<Index>(csc.column_start.size()) - 1;
    return {n, n, static_cast<Index>(csc.row.size()), csc.column_start.data(), csc.row.data(), csc.value.data()};
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
  if (implementation_->factor.info() != Eigen::Success)
    return {Outcome::not_positive_definite, "Cholesky (eigen): a pivot is not positive: the matrix is not positive definite"};
  return {};
}

Status EigenCholesky::solve(std::span<const double> b, std::span<double> x) {
  const Eigen::Map<const Eigen::VectorXd> rhs(b.data(), static_cast<Eigen::Index>(b.size()));
  Eigen::VectorXd solution = implementation_->factor.solve(rhs);
  std::copy(solution.data(), solution.data() + solution.size(), x.begin());
  return {};
}

FactorStatistics EigenCholesky::statistics() const {
  const double nonzeros = static_cast<double>(implementation_->factor.matrixL().nestedExpression().nonZeros());
  return {nonzeros, 0.0, nonzeros * (sizeof(double) + sizeof(Index)), "amd"};
}

}  // namespace taut
