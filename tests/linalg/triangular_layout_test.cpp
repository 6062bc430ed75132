#include "taut/linalg/triangular_layout.h"

#include <gtest/gtest.h>

#include "linalg/incomplete_factors.h"

namespace taut::test {
namespace {

std::vector<std::vector<Index>> grid(Index width, Index height) {
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(width * height));
  for (Index y = 0; y < height; ++y)
    for (Index x = 0; x < width; ++x) {
      const Index i = y * width + x;
      if (x > 0) columns[i].push_back(i - 1), columns[i - 1].push_back(i);
      if (y > 0) columns[i].push_back(i - width), columns[i - width].push_back(i);
    }
  return columns;
}

TEST(TriangularLayout, LevelsOfAGridAreItsDiagonals) {
  const TriangularLayout layout = triangular_layout(make_pattern(grid(7, 5), 3), false);
  EXPECT_EQ(layout.levels, 7 + 5 - 1);
  const std::vector<Index> first{0, 1, 7, 2, 8, 14};
  EXPECT_TRUE(std::equal(first.begin(), first.end(), layout.node.begin()));
}

TEST(TriangularLayout, KeepsEachBlockOnItsSideAndBeforeItsUse) {
  Random random(1);
  for (const Index dim : {3, 0}) {
    const auto pattern = pattern_of(random, random_graph(random, 60, 3, 20), dim);
    const TriangularLayout layout = triangular_layout(pattern, true);
    std::vector<int> seen(static_cast<std::size_t>(pattern->blocks()), 0);
    for (Index p = 0; p < layout.places(); ++p) {
      EXPECT_GT(layout.dim[p], 0);
      const auto check = [&](const TriangularRows& rows, bool below) {
        for (Index k = rows.start[p]; k < rows.start[p + 1]; ++k) {
          EXPECT_EQ(rows.column[k] < p, below);
          EXPECT_EQ(layout.node[rows.column[k]] < layout.node[p], below);
          EXPECT_EQ(pattern->column[rows.source[k]], layout.node[rows.column[k]]);
          ++seen[rows.source[k]];
        }
      };
      check(layout.lower, true);
      check(layout.upper, false);
      ++seen[pattern->diagonal[layout.node[p]]];
    }
    for (Index i = 0; i < pattern->rows(); ++i)
      for (Index k = pattern->row_start[i]; k < pattern->row_start[i + 1]; ++k)
        EXPECT_EQ(seen[k], pattern->dim(i) > 0 && pattern->dim(pattern->column[k]) > 0);
  }
}

}  // namespace
}  // namespace taut::test
