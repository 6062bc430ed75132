#include "taut/linalg/smoothed_aggregation.h"

#include <gtest/gtest.h>

#include <limits>

#include "linalg/incomplete_factors.h"
#include "taut/base/parallel.h"
#include "taut/linalg/aggregation.h"
#include "taut/linalg/pcg.h"

namespace taut::test {
namespace {

// Springs of stiffness 1 between the nodes of a cubic lattice, along edges and diagonals, and
// masses: K + mass I.
struct Lattice {
  BlockCsr a;
  std::vector<double> positions;
};

Lattice lattice(Index nx, Index ny, Index nz, double mass) {
  Lattice result;
  std::vector<Vec3> x;
  for (Index k = 0; k < nz; ++k)
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) x.emplace_back(i, j, k);
  std::vector<std::vector<Index>> columns(x.size());
  const auto linked = [&](Index p, Index q) {
    return p != q && (x[p] - x[q]).cwiseAbs().maxCoeff() < 1.5;
  };
  const Index n = static_cast<Index>(x.size());
  for (Index p = 0; p < n; ++p)
    for (Index q = 0; q < n; ++q)
      if (linked(p, q)) columns[p].push_back(q);
  result.a = BlockCsr(make_pattern(columns, 3));
  const BlockPattern& pattern = *result.a.pattern;
  for (Index p = 0; p < n; ++p) {
    Mat3 diagonal = mass * Mat3::Identity();
    const auto put = [&](Index k, const Mat3& m) {
      for (Index r = 0; r < 3; ++r)
        for (Index c = 0; c < 3; ++c) result.a.block(p, k)[r * pattern.width(p) + c] = m(r, c);
    };
    for (Index k = pattern.row_start[p]; k < pattern.row_start[p + 1]; ++k) {
      if (pattern.column[k] == p) continue;
      const Vec3 e = (x[pattern.column[k]] - x[p]).normalized();
      put(k, -e * e.transpose());
      diagonal += e * e.transpose();
    }
    put(pattern.diagonal[p], diagonal);
  }
  for (const Vec3& point : x)
    result.positions.insert(result.positions.end(), point.data(), point.data() + 3);
  return result;
}

// The five-point Laplacian with Dirichlet boundary.
BlockCsr poisson(Index width) {
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(width * width));
  for (Index i = 0; i < width * width; ++i) {
    if (i % width > 0) columns[i].push_back(i - 1), columns[i - 1].push_back(i);
    if (i >= width) columns[i].push_back(i - width), columns[i - width].push_back(i);
  }
  BlockCsr a(make_pattern(std::move(columns), 1));
  for_each_entry(
      a, [](Index row, Index column, double& value) { value = row == column ? 4.0 : -1.0; });
  return a;
}

int iterations(const BlockCsr& a, const Preconditioner& m) {
  Random random(1);
  const std::vector<double> b = random.vector(a.dofs());
  std::vector<double> x(b.size(), 0.0);
  const KrylovResult result = pcg(BlockCsrOperator(a), m, b, x, {1e-8, 2000, {}});
  EXPECT_TRUE(result.status.ok()) << result.status.message;
  return result.iterations;
}

TEST(Aggregation, CoversAGridWithConnectedGroups) {
  const BlockCsr a = poisson(40);
  WeightedGraph graph{{0}, {}, {}};
  for (Index i = 0; i < a.rows(); ++i) {
    for (Index k = a.pattern->row_start[i]; k < a.pattern->row_start[i + 1]; ++k)
      if (a.pattern->column[k] != i)
        graph.neighbour.push_back(a.pattern->column[k]), graph.weight.push_back(1.0);
    graph.start.push_back(static_cast<Index>(graph.neighbour.size()));
  }
  const Aggregation result = aggregate(graph);
  EXPECT_LT(result.groups, 1600 / 3);
  EXPECT_GT(result.groups, 1600 / 12);
  std::vector<int> size(static_cast<std::size_t>(result.groups), 0);
  for (Index i = 0; i < 1600; ++i) {
    ASSERT_TRUE(result.group[i] >= 0 && result.group[i] < result.groups);
    ++size[result.group[i]];
    bool has_neighbour = false;
    for (Index k = graph.start[i]; k < graph.start[i + 1]; ++k)
      has_neighbour |= result.group[graph.neighbour[k]] == result.group[i];
    EXPECT_TRUE(has_neighbour) << i;
  }
  EXPECT_GT(std::ranges::min(size), 1);
  // Nodes without neighbours stand alone.
  EXPECT_EQ(aggregate({{0, 0, 0, 0}, {}, {}}).groups, 3);
}

// A free spring network does not resist them.
TEST(RigidMotions, AreTheNullSpaceOfSprings) {
  const Lattice free = lattice(4, 3, 3, 0.0);
  const NearNullSpace space = rigid_motions(free.a.rows(), free.positions);
  ASSERT_EQ(space.modes, 6);
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>> modes(
      space.values.data(), free.a.dofs(), 6);
  EXPECT_LT((dense(free.a) * modes).norm(), 1e-12);
  const Eigen::VectorXd sizes = modes.colPivHouseholderQr().matrixQR().diagonal().cwiseAbs();
  EXPECT_GT(sizes.minCoeff(), 0.1 * sizes.maxCoeff());  // independent, and of one scale
  EXPECT_EQ(rigid_motions(5, {}).modes, 3);
}

TEST(SmoothedAggregation, IsSymmetricPositiveDefinite) {
  Random random(2);
  for (const Index dim : {3, 1, 0}) {
    const BlockCsr a =
        random_spd(random, pattern_of(random, random_graph(random, 150, 2, 6), dim), 1e-2);
    SmoothedAggregation amg({.coarsest_nodes = 5});
    ASSERT_TRUE(amg.update(a).ok());
    EXPECT_GE(amg.level_nodes().size(), 3u);
    const Eigen::MatrixXd inverse = dense_inverse(amg, a.dofs());
    EXPECT_LT((inverse - inverse.transpose()).norm(), 1e-12 * inverse.norm());
    EXPECT_GT(inverse.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
  }
}

// What multigrid is for: iterations that do not grow with the grid.
TEST(SmoothedAggregation, IterationsDoNotGrowWithTheGrid) {
  std::vector<int> multigrid, diagonal;
  for (const Index width : {24, 96}) {
    const BlockCsr a = poisson(width);
    SmoothedAggregation amg;
    DiagonalPreconditioner jacobi;
    ASSERT_TRUE(amg.update(a).ok() && jacobi.update(a).ok());
    multigrid.push_back(iterations(a, amg)), diagonal.push_back(iterations(a, jacobi));
  }
  EXPECT_GT(diagonal[1], 3 * diagonal[0]);
  EXPECT_LT(multigrid[1], multigrid[0] + 7);
  EXPECT_LT(multigrid[1], 25);
}

TEST(SmoothedAggregation, RotationsMatterToAnElasticBody) {
  const Lattice body = lattice(16, 5, 5, 1e-6);
  SmoothedAggregation translations, motions;
  motions.set_near_null_space(rigid_motions(body.a.rows(), body.positions));
  ASSERT_TRUE(translations.update(body.a).ok() && motions.update(body.a).ok());
  const int with = iterations(body.a, motions), without = iterations(body.a, translations);
  EXPECT_LT(with, 25);
  EXPECT_LT(1.5 * with, without);
  EXPECT_LT(motions.operator_complexity(), 2.0);
}

// A straight line of nodes has one rotation less: the column that vanishes is left out.
TEST(SmoothedAggregation, DropsDependentMotions) {
  const Lattice line = lattice(60, 1, 1, 0.5);
  SmoothedAggregation amg({.coarsest_nodes = 4});
  amg.set_near_null_space(rigid_motions(60, line.positions));
  ASSERT_TRUE(amg.update(line.a).ok());
  EXPECT_LT(iterations(line.a, amg), 15);
}

TEST(SmoothedAggregation, OneNodeAndNone) {
  BlockCsr one(make_pattern({{0}}, 3));
  one.values = {4.0, 1.0, 0.0, 1.0, 3.0, 1.0, 0.0, 1.0, 2.0};
  SmoothedAggregation amg;
  ASSERT_TRUE(amg.update(one).ok());
  EXPECT_LE(iterations(one, amg), 3);
  const std::vector<Index> held{0, 0, 0};
  const BlockCsr none(make_pattern(chain(3), held));
  ASSERT_TRUE(amg.update(none).ok());
  amg.apply({}, {});
}

TEST(SmoothedAggregation, SameBitsForAnyNumberOfThreads) {
  const int before = thread_count();
  const BlockCsr a = poisson(150);
  std::vector<std::vector<double>> found;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    SmoothedAggregation amg;
    ASSERT_TRUE(amg.update(a).ok());
    found.emplace_back(static_cast<std::size_t>(a.dofs()));
    amg.apply(Random(3).vector(a.dofs()), found.back());
  }
  set_thread_count(before);
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
}

TEST(SmoothedAggregation, ReportsWhereTheMatrixIsNotPositive) {
  Random random(4);
  const BlockCsr good = random_spd(random, make_pattern(random_graph(random, 90, 2, 10), 3));
  for (const double bad : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    BlockCsr a = good;
    a.block(7, a.pattern->diagonal[7])[a.pattern->width(7) + 1] = bad;
    SmoothedAggregation amg;
    const Status status = amg.update(a);
    EXPECT_EQ(status.outcome,
              std::isfinite(bad) ? Outcome::not_positive_definite : Outcome::not_finite);
    EXPECT_NE(status.message.find("node 7"), std::string::npos) << status.message;
  }
}

}  // namespace
}  // namespace taut::test
