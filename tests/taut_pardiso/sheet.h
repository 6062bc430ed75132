#pragma once
// Matrices with the pattern of a sheet of cloth, large enough for a factorisation to cost more than
// a few iterations.

#include "linalg/random_matrix.h"

namespace taut::test {

// A sheet of side x side nodes, each coupled to its eight neighbours.
inline BlockCsr sheet(Random& random, Index side) {
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(side * side));
  for (Index i = 0; i < side * side; ++i)
    for (Index j = 0; j < side * side; ++j)
      if (i != j && std::abs(i % side - j % side) <= 1 && std::abs(i / side - j / side) <= 1)
        columns[i].push_back(j);
  return random_spd(random, make_pattern(std::move(columns), 3));
}

// D A D with a diagonal D between 1 and 1 + change: as definite as A, and far from it when change
// is large.
inline void stiffen(Random& random, BlockCsr& a, double change) {
  std::vector<double> d(static_cast<std::size_t>(a.dofs()));
  for (double& value : d) value = 1.0 + change * random.uniform(0.0, 1.0);
  for_each_entry(a, [&](Index row, Index column, double& value) { value *= d[row] * d[column]; });
}

}  // namespace taut::test
