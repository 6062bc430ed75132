#include "taut/solve/core_bound.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "taut/base/parallel.h"

namespace taut {

namespace {

// Σ of the row's blocks outside the core.
Mat3 deleted_blocks(const BlockCsr& a, std::span<const std::uint8_t> core, Index i) {
  const BlockPattern& p = *a.pattern;
  Mat3 sum = Mat3::Zero();
  for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
    if (core[k] || k == p.diagonal[i]) continue;
    const double* block = a.block(i, k);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) sum(r, c) += block[r * p.width(i) + c];
  }
  return sum;
}

double largest_eigenvalue(const Mat3& m) {
  const Mat3 symmetric = 0.5 * (m + m.transpose());
  Eigen::SelfAdjointEigenSolver<Mat3> eigen;
  eigen.computeDirect(symmetric, Eigen::EigenvaluesOnly);
  // The closed form is exact to about 1e-8 of the norm; the bound must not be missed by rounding.
  return std::max(0.0, eigen.eigenvalues()[2] + 1e-7 * symmetric.norm());
}

// Of row i, those outside the core: as springs' are, but for rounding.
bool has_symmetric_blocks(const BlockCsr& a, std::span<const std::uint8_t> core, Index i) {
  const BlockPattern& p = *a.pattern;
  for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
    if (core[k] || k == p.diagonal[i]) continue;
    const Eigen::Map<const Mat3, 0, Eigen::OuterStride<>> block(a.block(i, k), Eigen::OuterStride<>(p.width(i)));
    if (!((block - block.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * block.cwiseAbs().maxCoeff())) return false;
  }
  return true;
}

}  // namespace

double remainder_ratio(const BlockCsr& a, std::span<const std::uint8_t> core, std::span<const double> masses) {
  assert(a.pattern->uniform_dim == 3 && static_cast<Index>(masses.size()) == a.rows());
  std::vector<double> ratio(masses.size(), 0.0);
  parallel_for(a.rows(), 256, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      ratio[i] = has_symmetric_blocks(a, core, i) ? largest_eigenvalue(-deleted_blocks(a, core, i)) / masses[i] : -1.0;
  });
  if (std::ranges::any_of(ratio, [](double r) { return r < 0.0; })) return -1.0;
  return ratio.empty() ? 0.0 : *std::ranges::max_element(ratio);
}

double block_diagonal_condition(const BlockCsr& a) {
  const BlockPattern& p = *a.pattern;
  assert(p.uniform_dim > 0);
  std::vector<double> ratio(static_cast<std::size_t>(p.rows()), 0.0);
  parallel_for(p.rows(), 256, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      double sum = 0.0, diagonal = 0.0;
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
        for (Index r = 0; r < p.dim(i); ++r) {
          const double entry = a.block(i, k)[r * p.width(i) + r];
          sum += entry;
          if (k == p.diagonal[i]) diagonal += entry;
        }
      ratio[static_cast<std::size_t>(i)] = sum > 1e-14 * diagonal ? diagonal / sum : std::numeric_limits<double>::infinity();
    }
  });
  return 2.0 * (ratio.empty() ? 1.0 : *std::ranges::max_element(ratio));
}

int core_iteration_bound(double rho, double start_value, double tolerance) {
  return iteration_bound(2.0 * (1.0 + rho), start_value, tolerance);
}

int iteration_bound(double condition, double start_value, double tolerance) {
  if (start_value <= tolerance) return 0;
  const double root = std::sqrt(condition);
  return static_cast<int>(std::max(1.0, std::ceil(0.5 * root * std::log(2.0 * root * start_value / tolerance))));
}

}  // namespace taut
