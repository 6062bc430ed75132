// Which pairs have a parallelogram, and what it is: B on the sides and -B on the other diagonal.

#include "taut/linalg/parallelogram.h"

#include <gtest/gtest.h>

#include "linalg/spring_grid.h"

namespace taut::test {
namespace {

// One of the two diagonals of each cell kept, in turn.
std::vector<std::uint8_t> one_diagonal_kept(const SpringGrid& grid) {
  std::vector<std::uint8_t> kept = grid.sides;
  for (Index v = 0; v + 1 < grid.nv; ++v)
    for (Index u = 0; u + 1 < grid.nu; ++u) {
      const bool rising = (u + v) % 2 == 0;
      const Index i = grid.node(u + (rising ? 0 : 1), v),
                  j = grid.node(u + (rising ? 1 : 0), v + 1);
      kept[grid.a.pattern->find(i, j)] = kept[grid.a.pattern->find(j, i)] = 1;
    }
  return kept;
}

TEST(Parallelogram, OneForEachCellsOtherDiagonal) {
  Random random(1);
  const SpringGrid grid(random, 6, 5);
  const BlockPattern& p = *grid.a.pattern;
  const std::vector<std::uint8_t> kept = one_diagonal_kept(grid);
  const std::vector<Parallelogram> list = parallelograms(p, grid.sides, kept);
  EXPECT_EQ(list.size(), 20u);  // none for springs two nodes apart
  for (const Parallelogram& of : list) {
    EXPECT_LT(of.a, of.c);
    EXPECT_EQ(of.block, p.find(of.a, of.c));
    EXPECT_EQ(of.opposite, p.find(of.c, of.a));
    EXPECT_EQ(of.a + of.c, of.b + of.d) << "no cell";
    EXPECT_TRUE(kept[p.find(of.b, of.d)]);
    EXPECT_FALSE(kept[of.block]);
    for (const auto& [i, j] : {std::pair{of.a, of.b}, {of.b, of.c}, {of.c, of.d}, {of.d, of.a}})
      EXPECT_TRUE(grid.sides[p.find(i, j)]);
  }
  for (std::size_t k = 1; k < list.size(); ++k)
    EXPECT_TRUE(list[k - 1].a < list[k].a ||
                (list[k - 1].a == list[k].a && list[k - 1].c < list[k].c));
}

TEST(Parallelogram, NoneWhereADiagonalOrASideIsMissing) {
  Random random(2);
  const SpringGrid grid(random, 3, 2);
  const BlockPattern& p = *grid.a.pattern;
  EXPECT_TRUE(parallelograms(p, grid.sides, grid.sides).empty()) << "without the other diagonal";
  std::vector<std::uint8_t> sides = grid.sides, kept = one_diagonal_kept(grid);
  ASSERT_EQ(parallelograms(p, sides, kept).size(), 2u);
  // An edge of the first cell only.
  sides[p.find(0, 3)] = sides[p.find(3, 0)] = 0;
  EXPECT_EQ(parallelograms(p, sides, kept).size(), 1u);
}

// The two triangles of an edge, and nodes two apart on the border of a grid whose cells' diagonals
// are sides: 0 and 2 have 1 and 4 in common.
TEST(Parallelogram, NoneAcrossASide) {
  Random random(2);
  const SpringGrid grid(random, 3, 2);
  const BlockPattern& p = *grid.a.pattern;
  std::vector<std::uint8_t> sides(grid.sides.size(), 1);
  for (const auto& [i, j] : {std::pair{0, 2}, {3, 5}})
    sides[p.find(i, j)] = sides[p.find(j, i)] = 0;
  EXPECT_TRUE(parallelograms(p, sides, sides).empty());
  sides = one_diagonal_kept(grid);
  EXPECT_TRUE(parallelograms(p, sides, sides).empty());
}

// The law of parallelograms: what stands in is the spring and B of a - b + c - d.
TEST(Parallelogram, StandsInForTheSpring) {
  Random random(3);
  const SpringGrid grid(random, 4, 4);
  const std::vector<std::uint8_t> kept = one_diagonal_kept(grid);
  const std::vector<Parallelogram> list = parallelograms(*grid.a.pattern, grid.sides, kept);
  const Eigen::MatrixXd a = dense(grid.a), dropped = dense_core(grid.a, kept, {}),
                        replaced = dense_core(grid.a, kept, list);
  const auto energy = [](const Eigen::MatrixXd& m, const Eigen::VectorXd& x) {
    return x.dot(m * x);
  };
  for (int trial = 0; trial < 3; ++trial) {
    const std::vector<double> random_motion = random.vector(grid.a.dofs());
    const Eigen::VectorXd x = as_eigen(random_motion);
    const auto at = [&](Index i) { return Vec3(x.segment<3>(3 * i)); };
    double expected = energy(dropped, x);
    for (const Parallelogram& of : list) {
      const Mat3 b = -a.block<3, 3>(3 * of.a, 3 * of.c);
      const Vec3 across = at(of.a) - at(of.c), bent = at(of.a) - at(of.b) + at(of.c) - at(of.d);
      expected += across.dot(b * across) + bent.dot(b * bent);
    }
    EXPECT_NEAR(energy(replaced, x), expected, 1e-12 * expected);
  }
  // Affine over the grid: the springs themselves, but for those two nodes apart.
  Mat3 gradient;
  for (int c = 0; c < 3; ++c) gradient.col(c) = random.direction();
  Eigen::VectorXd affine(grid.a.dofs());
  for (Index i = 0; i < grid.nu * grid.nv; ++i)
    affine.segment<3>(3 * i) = gradient * Vec3(i % grid.nu, i / grid.nu, 1.0);
  std::vector<std::uint8_t> with_diagonals = kept;
  for (const Parallelogram& of : list) with_diagonals[of.block] = with_diagonals[of.opposite] = 1;
  EXPECT_NEAR(energy(replaced, affine), energy(dense_core(grid.a, with_diagonals, {}), affine),
              1e-12 * energy(a, affine));
}

}  // namespace
}  // namespace taut::test
