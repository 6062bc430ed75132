#pragma once
// What the tests of the incomplete factorisations share: the preconditioner as a dense matrix, and
// its comparison with A on A's pattern.

#include "linalg/random_matrix.h"
#include "taut/linalg/preconditioner.h"

namespace taut::test {

// M⁻¹, column by column.
inline Eigen::MatrixXd dense_inverse(const Preconditioner& m, Index n) {
  Eigen::MatrixXd inverse(n, n);
  for (Index c = 0; c < n; ++c) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(n, c);
    m.apply({unit.data(), static_cast<std::size_t>(n)},
            {inverse.col(c).data(), static_cast<std::size_t>(n)});
  }
  return inverse;
}

// Largest |M - A| where A has a block.
inline double difference_on_pattern(const Eigen::MatrixXd& m, BlockCsr a) {
  double largest = 0.0;
  for_each_entry(a, [&](Index row, Index column, double& value) {
    largest = std::max(largest, std::abs(m(row, column) - value));
  });
  return largest;
}

inline std::vector<std::vector<Index>> chain(Index nodes) {
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(nodes));
  for (Index i = 0; i + 1 < nodes; ++i) columns[i].push_back(i + 1), columns[i + 1].push_back(i);
  return columns;
}

// 3: all nodes of three unknowns, 1: of one, 0: mixed.
inline std::shared_ptr<const BlockPattern> pattern_of(Random& random,
                                                      std::vector<std::vector<Index>> graph,
                                                      Index dim) {
  if (dim > 0) return make_pattern(std::move(graph), dim);
  const auto dims = random_dims(random, static_cast<Index>(graph.size()));
  return make_pattern(std::move(graph), dims);
}

}  // namespace taut::test
