#pragma once
// Random sparse matrices for tests, and the same as dense matrices of Eigen, which judge the
// results.

#include <Eigen/Dense>
#include <random>
#include <set>
#include <span>
#include <vector>

#include "taut/linalg/block_csr.h"

namespace taut::test {

// The same numbers with every standard library.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  double uniform(double low = -1.0, double high = 1.0) {
    return low + (high - low) * (engine_() / 4294967296.0);
  }
  Index below(Index n) { return static_cast<Index>(engine_() % static_cast<std::uint32_t>(n)); }
  std::vector<double> vector(Index n) {
    std::vector<double> v(static_cast<std::size_t>(n));
    for (double& value : v) value = uniform();
    return v;
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 v(uniform(), uniform(), uniform());
      if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
    }
  }

 private:
  std::mt19937 engine_;
};

// A connected, symmetric graph: a chain with `extra` random links a node, at most `reach` nodes
// apart.
inline std::vector<std::vector<Index>> random_graph(Random& random, Index nodes, Index extra,
                                                    Index reach) {
  std::vector<std::set<Index>> links(static_cast<std::size_t>(nodes));
  const auto link = [&](Index i, Index j) { links[i].insert(j), links[j].insert(i); };
  for (Index i = 0; i + 1 < nodes; ++i) link(i, i + 1);
  for (Index i = 0; i < nodes; ++i)
    for (Index e = 0; e < extra; ++e) {
      const Index j = std::min(nodes - 1, i + 1 + random.below(reach));
      if (j != i) link(i, j);
    }
  std::vector<std::vector<Index>> columns;
  for (const auto& row : links) columns.emplace_back(row.begin(), row.end());
  return columns;
}

// Entry (r, c) of the block (i, j), both triangles visited.
template <class Visit>
void for_each_entry(BlockCsr& a, Visit visit) {
  const BlockPattern& p = *a.pattern;
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      for (Index r = 0; r < p.dim(i); ++r)
        for (Index c = 0; c < p.dim(p.column[k]); ++c)
          visit(p.dof_start[i] + r, p.dof_start[p.column[k]] + c,
                a.block(i, k)[r * p.width(i) + c]);
}

inline BlockCsr random_matrix(Random& random, std::shared_ptr<const BlockPattern> pattern) {
  BlockCsr a(std::move(pattern));
  for (double& value : a.values) value = random.uniform();
  return a;
}

// Symmetric and diagonally dominant by a share of `margin`. But for the signs of the unknowns it is
// the Laplacian of a graph, so that its condition number really is of the order of 1/margin.
inline BlockCsr random_spd(Random& random, std::shared_ptr<const BlockPattern> pattern,
                           double margin = 0.05) {
  BlockCsr a(std::move(pattern));
  std::vector<double> row_sum(static_cast<std::size_t>(a.dofs()), 0.0), sign(row_sum);
  for (double& s : sign) s = random.below(2) ? 1.0 : -1.0;
  for_each_entry(a, [&](Index row, Index column, double& value) {
    if (row == column) return;
    value = row > column ? a.at(column, row) : -sign[row] * sign[column] * random.uniform(0.0, 1.0);
    row_sum[row] += std::abs(value);
  });
  for_each_entry(a, [&](Index row, Index column, double& value) {
    if (row == column) value = row_sum[row] * (1.0 + margin * random.uniform(0.0, 2.0)) + margin;
  });
  return a;
}

inline Eigen::MatrixXd dense(const BlockCsr& a) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(a.dofs(), a.dofs());
  for_each_entry(const_cast<BlockCsr&>(a),
                 [&](Index row, Index column, double& value) { result(row, column) = value; });
  return result;
}

inline Eigen::Map<const Eigen::VectorXd> as_eigen(std::span<const double> v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

inline double relative_difference(std::span<const double> found, const Eigen::VectorXd& expected) {
  return (as_eigen(found) - expected).norm() / std::max(expected.norm(), 1e-300);
}

// dims cycling through 0..3 at random.
inline std::vector<Index> random_dims(Random& random, Index nodes) {
  std::vector<Index> dims(static_cast<std::size_t>(nodes));
  for (Index& dim : dims) dim = random.below(4);
  return dims;
}

}  // namespace taut::test
