#pragma once
// One level of smoothed aggregation with its way to the next: nodes of n unknowns here, of c
// below. See linalg/smoothed_aggregation.h. Blocks of nodes with fewer unknowns are padded:
// zeros, ones on the diagonal.

#include <Eigen/Cholesky>
#include <cmath>

#include "taut/linalg/aggregation.h"
#include "taut/linalg/block_sparse.h"
#include "taut/linalg/smoothed_aggregation.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

template <int n, int c>
struct AmgLevel {
  using Square = typename BlockSparse<n, n>::Block;
  using Modes = typename BlockSparse<n, c>::Block;
  using CoarseModes = typename BlockSparse<c, c>::Block;

  BlockSparse<n, n> a;
  std::vector<Modes> modes;  // the near-null space, a block a node
  std::vector<Square> inverse_diagonal;
  BlockSparse<n, c> prolongator;
  BlockSparse<c, n> restrictor;
  double lambda = 0.0;
  mutable std::vector<double> residual, step, scratch;

  Index nodes() const { return a.rows(); }
  std::size_t size() const { return static_cast<std::size_t>(a.rows()) * n; }
  Offset bytes() const {
    return a.bytes() + prolongator.bytes() + restrictor.bytes() +
           static_cast<Offset>(inverse_diagonal.size() * sizeof(Square) +
                               modes.size() * sizeof(Modes) + 3 * size() * sizeof(double));
  }

  // After `a` is filled. The node whose diagonal block is not positive definite, or -1.
  Index prepare() {
    for (auto* v : {&residual, &step, &scratch}) v->assign(size(), 0.0);
    inverse_diagonal.resize(static_cast<std::size_t>(nodes()));
    for (Index i = 0; i < nodes(); ++i)
      for (Index k = a.start[i]; k < a.start[i + 1]; ++k) {
        if (a.column[k] != i) continue;
        const Eigen::LLT<Eigen::Matrix<double, n, n>> llt(a.values[k]);
        if (llt.info() != Eigen::Success || !a.values[k].allFinite()) return i;
        const Eigen::Matrix<double, n, n> inverse =
            llt.solve(Eigen::Matrix<double, n, n>::Identity());
        inverse_diagonal[i] = 0.5 * (inverse + inverse.transpose());
      }
    lambda = largest_eigenvalue();
    return -1;
  }

  // y = D⁻¹ x
  void jacobi(const double* x, double* y) const {
    using Vector = Eigen::Matrix<double, n, 1>;
    parallel_for(nodes(), 1024, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const std::ptrdiff_t at = n * static_cast<std::ptrdiff_t>(i);
        Eigen::Map<Vector>(y + at).noalias() =
            inverse_diagonal[i] * Eigen::Map<const Vector>(x + at);
      }
    });
  }

  // Power iteration on D⁻¹A from a vector without symmetry.
  double largest_eigenvalue() const {
    constexpr int iterations = 15;
    std::uint32_t state = 1;
    for (double& value : step)
      value = (state = 1664525u * state + 1013904223u) / 4294967296.0 - 0.5;
    double found = 1.0;
    for (int k = 0; k < iterations; ++k) {
      const double before = norm(step);
      if (!(before > 0.0)) break;
      multiply(a, step.data(), scratch.data());
      jacobi(scratch.data(), step.data());
      found = norm(step) / before;
      for (double& value : step) value /= found * before;
    }
    return found;
  }

  // x += q(D⁻¹A) D⁻¹ (b - A x), q the Chebyshev smoother (Saad, "Iterative Methods", algorithm
  // 12.1). x_is_zero saves the first product.
  void smooth(const AmgOptions& options, std::span<const double> b, std::span<double> x,
              bool x_is_zero) const {
    const double high = 1.1 * lambda, low = lambda / options.smoother_range;
    const double middle = 0.5 * (high + low), half = 0.5 * (high - low), sigma = middle / half;
    std::copy(b.begin(), b.end(), residual.begin());
    if (!x_is_zero) {
      multiply(a, x.data(), scratch.data());
      add_scaled(-1.0, scratch, residual);
    }
    jacobi(residual.data(), step.data());
    for (double& value : step) value /= middle;
    add_scaled(1.0, step, x);
    double rho = 1.0 / sigma;
    for (int k = 1; k < options.smoother_degree; ++k) {
      multiply(a, step.data(), scratch.data());
      add_scaled(-1.0, scratch, residual);
      jacobi(residual.data(), scratch.data());
      const double next = 1.0 / (2.0 * sigma - rho);
      for (std::size_t i = 0; i < step.size(); ++i)
        step[i] = next * rho * step[i] + 2.0 * next / half * scratch[i];
      add_scaled(1.0, step, x);
      rho = next;
    }
  }

  WeightedGraph graph(double strength) const {
    std::vector<double> size_of(static_cast<std::size_t>(nodes()), 0.0);
    for (Index i = 0; i < nodes(); ++i)
      for (Index k = a.start[i]; k < a.start[i + 1]; ++k)
        if (a.column[k] == i) size_of[i] = a.values[k].norm();
    WeightedGraph result;
    result.start.push_back(0);
    for (Index i = 0; i < nodes(); ++i) {
      for (Index k = a.start[i]; k < a.start[i + 1]; ++k) {
        const Index j = a.column[k];
        const double weight = a.values[k].norm() / std::sqrt(size_of[i] * size_of[j]);
        if (j != i && weight > 0.0 && weight >= strength)
          result.neighbour.push_back(j), result.weight.push_back(weight);
      }
      result.start.push_back(static_cast<Index>(result.neighbour.size()));
    }
    return result;
  }

  // P̂ and the coarse level's modes: modes = P̂ coarse_modes, the columns
  // of P̂ orthonormal or zero.
  BlockSparse<n, c> tentative(const Aggregation& groups,
                              std::vector<CoarseModes>& coarse_modes) const {
    BlockSparse<n, c> result;
    result.columns = groups.groups;
    result.column = groups.group;
    result.values = modes;
    for (Index i = 0; i < nodes(); ++i) result.start.push_back(i + 1);
    coarse_modes.assign(static_cast<std::size_t>(groups.groups), CoarseModes::Zero());
    std::vector<std::vector<Index>> members(static_cast<std::size_t>(groups.groups));
    for (Index i = 0; i < nodes(); ++i) members[groups.group[i]].push_back(i);
    for (Index g = 0; g < groups.groups; ++g)
      orthonormalize(members[g], result.values, coarse_modes[g]);
    return result;
  }

  // Modified Gram-Schmidt, twice, so that what is left of a nearly dependent
  // column is orthogonal too.
  static void orthonormalize(const std::vector<Index>& members, std::vector<Modes>& q,
                             CoarseModes& r) {
    const auto column_dot = [&](int s, int t) {
      double sum = 0.0;
      for (const Index i : members) sum += q[i].col(s).dot(q[i].col(t));
      return sum;
    };
    for (int t = 0; t < c; ++t) {
      const double before = std::sqrt(column_dot(t, t));
      for (int pass = 0; pass < 2; ++pass)
        for (int s = 0; s < t; ++s) {
          const double share = column_dot(s, t);
          r(s, t) += share;
          for (const Index i : members) q[i].col(t) -= share * q[i].col(s);
        }
      const double left = std::sqrt(column_dot(t, t));
      const bool dependent = !(left > 1e-8 * before);
      if (!dependent) r(t, t) = left;
      for (const Index i : members) q[i].col(t) *= dependent ? 0.0 : 1.0 / left;
    }
  }

  // Makes P and its transpose, and the coarse matrix and modes.
  template <class Coarse>
  void coarsen(double strength, Coarse& coarse) {
    const BlockSparse<n, c> plain = tentative(aggregate(graph(strength)), coarse.modes);
    prolongator = product(a, plain);
    const double omega = 4.0 / (3.0 * lambda);
    for (Index i = 0; i < nodes(); ++i)
      for (Index k = prolongator.start[i]; k < prolongator.start[i + 1]; ++k) {
        Modes block = -omega * (inverse_diagonal[i] * prolongator.values[k]);
        if (prolongator.column[k] == plain.column[i]) block += plain.values[i];
        prolongator.values[k] = block;
      }
    restrictor = transposed(prolongator);
    coarse.a = product(restrictor, product(a, prolongator));
    for (Index i = 0; i < coarse.nodes(); ++i)
      for (Index k = coarse.a.start[i]; k < coarse.a.start[i + 1]; ++k)
        if (coarse.a.column[k] == i)
          for (int t = 0; t < c; ++t)
            // a column that was dropped
            if (coarse.a.values[k](t, t) == 0.0) coarse.a.values[k](t, t) = 1.0;
  }
};

}  // namespace taut
