#include "taut/core/core_bound.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"

namespace taut {

namespace {

constexpr Index rows_at_once = 64;  // their blocks stay in the cache from core to core
// Within a part, eigenvalues are looked for only where they may be larger than what has been found.
// Parts do not depend on the threads.
constexpr Index rows_in_part = 1024;

typedef double Four __attribute__((vector_size(32)));
typedef double FourAnywhere __attribute__((vector_size(32), aligned(8), may_alias));

double largest_eigenvalue(const Mat3& symmetric) {
  Eigen::SelfAdjointEigenSolver<Mat3> eigen;
  eigen.computeDirect(symmetric, Eigen::EigenvaluesOnly);
  // The closed form is exact to about 1e-8 of the norm; the bound must not be missed by rounding.
  return std::max(0.0, eigen.eigenvalues()[2] + 1e-7 * symmetric.norm());
}

// Whether all eigenvalues of a symmetric matrix are less than `limit`: whether limit I - m is
// positive definite, by its minors.
TAUT_ALWAYS_INLINE bool is_below(const double (&m)[3][3], double limit) {
  const double a = limit - m[0][0], b = -m[1][0], c = -m[2][0], d = limit - m[1][1], e = -m[2][1],
               f = limit - m[2][2];
  const double minor = a * d - b * b;
  return a > 0.0 && minor > 0.0 && f * minor - (a * e * e - 2.0 * b * c * e + d * c * c) > 0.0;
}

// Of row i, those outside the core: as springs' are, but for rounding.
bool has_symmetric_blocks(const BlockCsr& a, std::span<const std::uint8_t> core, Index i) {
  const BlockPattern& p = *a.pattern;
  for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
    if (core[k] || k == p.diagonal[i]) continue;
    const Eigen::Map<const Mat3, 0, Eigen::OuterStride<>> block(a.block(i, k),
                                                                Eigen::OuterStride<>(p.width(i)));
    if (!((block - block.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * block.cwiseAbs().maxCoeff()))
      return false;
  }
  return true;
}

// Of rows begin ... end-1, but at least `largest`; -1: not known.
TAUT_MULTIVERSION double largest_ratio(const BlockCsr& a, const std::uint8_t* core, Index begin,
                                       Index end, const double* masses, double largest) {
  const BlockPattern& p = *a.pattern;
  for (Index i = begin; i < end; ++i) {
    const Index width = p.width(i), last = p.row_start[i + 1] - 1;
    // -Σ of the blocks outside the core, row by row, the fourth number of each nobody's
    Four sum[3] = {};
    bool are_symmetric = true, is_empty = true;
    for (Index k = p.row_start[i]; k <= last; ++k) {
      if (core[k] || k == p.diagonal[i]) continue;
      const double* block = a.values.data() + p.value_start[i] + p.block_offset[k];
      const double *second = block + width, *third = second + width;
      is_empty = false;
      are_symmetric &= (block[1] == second[0]) & (block[2] == third[0]) & (second[2] == third[1]);
      // nothing is read behind a row's last block: it may be the matrix's last
      for (Index r = 0; r < 3; ++r)
        sum[r] -= k < last
                      ? Four(*reinterpret_cast<const FourAnywhere*>(block + r * width))
                      : Four{block[r * width], block[r * width + 1], block[r * width + 2], 0.0};
    }
    if (is_empty) continue;
    if (!are_symmetric && !has_symmetric_blocks(a, {core, static_cast<std::size_t>(p.blocks())}, i))
      return -1.0;
    double symmetric[3][3];
    for (Index r = 0; r < 3; ++r)
      for (Index c = 0; c < 3; ++c) symmetric[r][c] = 0.5 * (sum[r][c] + sum[c][r]);
    if (is_below(symmetric, largest * masses[i])) continue;
    const double ratio = largest_eigenvalue(Eigen::Map<const Mat3>(&symmetric[0][0])) / masses[i];
    largest = ratio > largest ? ratio : largest;
  }
  return largest;
}

}  // namespace

std::vector<double> remainder_ratios(const BlockCsr& a,
                                     std::span<const std::span<const std::uint8_t>> cores,
                                     std::span<const double> masses) {
  assert(a.pattern->uniform_dim == 3 && static_cast<Index>(masses.size()) == a.rows());
  const Index rows = a.rows(), parts = (rows + rows_in_part - 1) / rows_in_part;
  std::vector<double> largest(static_cast<std::size_t>(parts) * cores.size(), 0.0);  // part by part
  parallel_for(parts, 1, [&](Index first_part, Index end_part) {
    for (Index part = first_part; part < end_part; ++part) {
      double* const of_part = largest.data() + static_cast<std::size_t>(part) * cores.size();
      const Index end = std::min(rows, rows_in_part * (part + 1));
      for (Index begin = rows_in_part * part; begin < end; begin += rows_at_once)
        for (std::size_t c = 0; c < cores.size(); ++c) {
          assert(static_cast<Index>(cores[c].size()) == a.pattern->blocks());
          if (of_part[c] >= 0.0)
            of_part[c] =
                largest_ratio(a, cores[c].data(), begin, std::min(end, begin + rows_at_once),
                              masses.data(), of_part[c]);
        }
    }
  });
  std::vector<double> result(cores.size(), 0.0);
  for (std::size_t at = 0; at < largest.size(); ++at) {
    double& of_core = result[at % cores.size()];
    of_core = of_core < 0.0 || largest[at] < 0.0 ? -1.0 : std::max(of_core, largest[at]);
  }
  return result;
}

double remainder_ratio(const BlockCsr& a, std::span<const std::uint8_t> core,
                       std::span<const double> masses) {
  return remainder_ratios(a, {&core, 1}, masses)[0];
}

double remainder_ratio(std::span<const Mat3> rest_diagonal, std::span<const double> masses) {
  assert(rest_diagonal.size() == masses.size());
  const Index rows = static_cast<Index>(masses.size()),
              parts = (rows + rows_in_part - 1) / rows_in_part;
  std::vector<double> largest(static_cast<std::size_t>(parts), 0.0);
  parallel_for(parts, 1, [&](Index first_part, Index end_part) {
    for (Index part = first_part; part < end_part; ++part)
      for (Index i = rows_in_part * part; i < std::min(rows, rows_in_part * (part + 1)); ++i)
        if (!rest_diagonal[i].isZero(0.0))
          largest[part] = std::max(largest[part], largest_eigenvalue(rest_diagonal[i]) / masses[i]);
  });
  return largest.empty() ? 0.0 : *std::ranges::max_element(largest);
}

bool may_be_springs(const BlockCsr& a, std::span<const std::uint8_t> core) {
  constexpr double rounding = 1e-9;
  const BlockPattern& p = *a.pattern;
  assert(p.uniform_dim == 3);
  for (Index i = 0; i < p.rows(); ++i) {
    if (!has_symmetric_blocks(a, core, i)) return false;
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
      if (core[k] || k == p.diagonal[i]) continue;
      const Mat3 block = Eigen::Map<const Mat3, 0, Eigen::OuterStride<>>(
          a.block(i, k), Eigen::OuterStride<>(p.width(i)));
      const Eigen::SelfAdjointEigenSolver<Mat3> eigen(block, Eigen::EigenvaluesOnly);
      if (!(eigen.eigenvalues()[2] <= rounding * block.norm())) return false;
    }
  }
  return true;
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
      ratio[static_cast<std::size_t>(i)] =
          sum > 1e-14 * diagonal ? diagonal / sum : std::numeric_limits<double>::infinity();
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
  constexpr double most = 1e9;  // also where the condition is infinite
  return static_cast<int>(std::clamp(
      std::ceil(0.5 * root * std::log(2.0 * root * start_value / tolerance)), 1.0, most));
}

}  // namespace taut
