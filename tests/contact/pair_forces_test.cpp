// What pushed pairs in a step, and rows that begin with it.

#include "taut/contact/pair_forces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace taut {
namespace {

ContactRow row_of(const std::array<Index, 4>& node, double lambda, const Vec3& normal,
                  const Vec3& tangential = Vec3::Zero()) {
  ContactRow row;
  row.node = node;
  row.lambda = lambda;
  row.normal = normal;
  row.tangential = tangential;
  row.inverse_mass = 1.0;
  return row;
}

TEST(PairForces, AreImpulsesOverTheStepSquared) {
  const std::vector<ContactRow> rows{row_of({7, 1, 2, 3}, 3e-6, Vec3::UnitZ(), Vec3(4e-6, 0, 0)),
                                     row_of({2, 3, 4, 5}, 1e-6, Vec3::UnitX()),
                                     row_of({2, 3, 4, 6}, 0.0, Vec3::UnitX()),
                                     row_of({5, -1, -1, -1}, 1.0, Vec3::UnitZ())};
  const std::vector<PairForce> list = forces_of(rows, 1e-3, 8);
  ASSERT_EQ(list.size(), 2u) << "what pushes, and not against a plane";
  EXPECT_TRUE(std::ranges::is_sorted(list, {}, [](const PairForce& f) { return f.node[0]; }));
  const PairForces forces(list, 8);
  EXPECT_LT((forces.of({7, 1, 2, 3}) - Vec3(4, 0, 3)).norm(), 1e-6);
  EXPECT_LT((forces.of({2, 3, 4, 5}) - Vec3(1, 0, 0)).norm(), 1e-6);
  EXPECT_EQ(forces.of({2, 3, 4, 6}), Vec3(Vec3::Zero()));
  EXPECT_EQ(forces.of({3, 2, 4, 5}), Vec3(Vec3::Zero()));
}

TEST(PairForces, OfSeveralRowsOfAPairAreAdded) {
  const std::vector<ContactRow> rows{row_of({1, 2, 3, 4}, 2.0, Vec3::UnitZ()),
                                     row_of({0, 2, 3, 4}, 1.0, Vec3::UnitZ()),
                                     row_of({1, 2, 3, 4}, 5.0, Vec3::UnitZ())};
  const std::vector<PairForce> list = forces_of(rows, 1.0, 5);
  EXPECT_EQ(PairForces(list, 5).of({1, 2, 3, 4}), Vec3(0, 0, 7));
}

TEST(PairForces, ManyRowsAreAllFound) {
  std::mt19937 random(3);
  std::uniform_int_distribution<Index> vertex(0, 499);
  std::vector<ContactRow> rows;
  for (Index k = 0; k < 9000; ++k)
    rows.push_back(
        row_of({vertex(random), vertex(random), vertex(random), 500 + k}, 1.0 + k, Vec3::UnitY()));
  const std::vector<PairForce> list = forces_of(rows, 1.0, 10'000);
  const PairForces forces(list, 10'000);
  for (const ContactRow& row : rows) ASSERT_EQ(forces.of(row.node), Vec3(0, row.lambda, 0));
}

TEST(PairForces, ARowBeginsWithWhatPushesApartAndWithinItsFrictionCone) {
  ContactRow row = row_of({0, 1, 2, 3}, 0.0, Vec3::UnitZ());
  row.friction = 0.5;
  begin_with(row, Vec3(3, 4, 2), 0.1);
  EXPECT_DOUBLE_EQ(row.lambda, 0.02);
  EXPECT_LT((row.tangential - 0.01 * Vec3(0.6, 0.8, 0)).norm(), 1e-15);
  ContactRow pulled = row_of({0, 1, 2, 3}, 0.0, Vec3::UnitZ());
  begin_with(pulled, Vec3(3, 4, -2), 0.1);
  EXPECT_EQ(pulled.lambda, 0.0);
  EXPECT_EQ(pulled.tangential, Vec3(Vec3::Zero()));
}

TEST(PairForces, NodesGetWhatTheirRowsBeginWith) {
  const std::vector<RowSlabs::Vertices> vertices{{0, 1, 2, 3}};
  std::vector<Vec3> x{Vec3(0.2, 0.2, 0.1), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const std::vector<double> inverse_mass{2.0, 1.0, 1.0, 0.0};
  std::vector<ContactRow> rows{row_of(vertices[0], 0.0, Vec3::UnitZ())};
  rows[0].weight = {1.0, -0.6, -0.2, -0.2};
  rows[0].friction = 1.0;
  weigh(rows[0], inverse_mass, x);
  begin_with(rows[0], Vec3(0.5, 0, 1), 1.0);
  const std::vector<Vec3> before = x;
  std::vector<std::uint8_t> moved(4);
  apply_impulses(rows, RowSlabs(vertices, x), x, moved);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_LT((x[k] - before[k] - inverse_mass[k] * rows[0].weight[k] * Vec3(0.5, 0, 1)).norm(),
              1e-15)
        << k;
  EXPECT_EQ(moved, (std::vector<std::uint8_t>{1, 1, 1, 0}));
  EXPECT_EQ(rows[0].pushed, Vec3(0.5, 0, 1)) << "what angular momentum is restored from";
}

}  // namespace
}  // namespace taut
