#include "taut/linalg/lanczos.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace taut {

SpectrumEnds spectrum_ends(const CgCoefficients& coefficients) {
  const auto& [alpha, beta] = coefficients;
  // The last β would belong to an iteration that was not made, or is not finite.
  std::ptrdiff_t n = 0;
  while (n < std::ssize(alpha) && std::isfinite(alpha[n]) && alpha[n] > 0.0) ++n;
  if (n == 0) return {};
  Eigen::VectorXd diagonal(n), beside(n - 1);
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    diagonal[k] = 1.0 / alpha[k] + (k > 0 ? beta[k - 1] / alpha[k - 1] : 0.0);
    if (k + 1 < n) beside[k] = std::sqrt(beta[k]) / alpha[k];
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
  eigen.computeFromTridiagonal(diagonal, beside, Eigen::EigenvaluesOnly);
  return {eigen.eigenvalues().minCoeff(), eigen.eigenvalues().maxCoeff()};
}

}  // namespace taut
