#include "taut/contact/row_slabs.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "taut/base/parallel.h"
#include "taut/contact/contact_row.h"

namespace taut {
namespace {

// Points in a long box and rows between random close ones, some of one point against a plane, some
// that span nearly the whole box.
struct Heap {
  std::vector<Vec3> x0, x1;
  std::vector<double> mass, inverse_mass;
  std::vector<ContactRow> rows;

  Heap(Index points, Index row_count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (Index i = 0; i < points; ++i) {
      x0.emplace_back(0.3 * unit(random), 2.0 * i / points, 0.2 * unit(random));
      x1.push_back(x0.back() + 1e-3 * Vec3(unit(random), unit(random), unit(random)));
      mass.push_back(0.5 + unit(random));
      inverse_mass.push_back(i % 17 == 0 ? 0.0 : 1.0 / mass.back());
    }
    std::uniform_int_distribution<Index> any(0, points - 1), near(1, 8);
    for (Index k = 0; k < row_count; ++k) {
      ContactRow row;
      row.node[0] = any(random);
      row.weight[0] = 1.0;
      row.normal = Vec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5).normalized();
      row.friction = k % 3 == 0 ? 0.4 : 0.0;
      if (k % 20 == 0) {
        row.target = row.normal.dot(x1[row.node[0]]) + 1e-4 * (unit(random) - 0.3);
      } else {
        const Index step = k % 50 == 1 ? points / 4 - 1 : near(random);
        for (Index c = 1; c < 4; ++c) row.node[c] = (row.node[0] + c * step) % points;
        const double b = unit(random), c = unit(random) * (1.0 - b);
        row.weight = {1.0, -b, -c, b + c - 1.0};
        row.target = row.normal.dot(separation(row, x1)) + 1e-4 * (unit(random) - 0.3);
      }
      weigh(row, inverse_mass, x0);
      rows.push_back(row);
    }
  }
  std::vector<RowSlabs::Vertices> vertices() const {
    std::vector<RowSlabs::Vertices> vertices;
    for (const ContactRow& row : rows) vertices.push_back(row.node);
    return vertices;
  }
  // The last tenth of the rows comes later.
  std::vector<Vec3> met(int iterations, double tolerance) {
    std::vector<Vec3> x = x1;
    std::vector<RowSlabs::Vertices> early = vertices();
    early.resize(rows.size() - rows.size() / 10);
    const RowSlabs slabs(early, x1);
    std::vector<ContactRow> placed = rows;
    for (std::size_t k = 0; k < early.size(); ++k) placed[slabs.place(k)] = rows[k];
    rows = placed;
    std::vector<std::uint8_t> awake(x.size(), 1), moved(x.size(), 0);
    satisfy_rows(rows, slabs, x, awake, moved, iterations, tolerance);
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_TRUE(moved[i] || x[i] == x1[i]) << "point " << i;
    return x;
  }
};

TEST(RowSlabs, HoldEachRowOnceAndGroupsOfAPhaseShareNothing) {
  for (const Index count : {Index{0}, Index{10}, Index{9000}}) {
    const Heap heap(4000, count, 1);
    const std::vector<RowSlabs::Vertices> vertices = heap.vertices();
    const RowSlabs slabs(vertices, heap.x1);
    std::vector<Index> row_at(vertices.size(), -1);
    for (std::size_t k = 0; k < vertices.size(); ++k)
      row_at[slabs.place(k)] = static_cast<Index>(k);
    EXPECT_EQ(slabs.start(0), 0);
    EXPECT_EQ(slabs.start(RowSlabs::groups), count);
    for (Index phase = 0; phase < RowSlabs::phases; ++phase) {
      std::vector<Index> owner(heap.x0.size(), -1);
      for (Index g = slabs.first_group(phase); g < slabs.first_group(phase + 1); ++g) {
        for (Index place = slabs.start(g); place < slabs.start(g + 1); ++place) {
          ASSERT_GE(row_at[place], 0) << "two rows in one place";
          EXPECT_TRUE(place == slabs.start(g) || row_at[place] > row_at[place - 1])
              << "not in their own order";
          for (const Index node : vertices[row_at[place]]) {
            if (node < 0) continue;
            ASSERT_TRUE(owner[node] < 0 || owner[node] == g)
                << "groups " << owner[node] << " and " << g << " share vertex " << node;
            owner[node] = g;
          }
        }
      }
    }
    EXPECT_EQ(slabs.start(RowSlabs::groups - 1), count) << "none of them comes later";
    if (count < RowSlabs::fewest_rows) continue;
    EXPECT_GT(slabs.start(RowSlabs::slabs), count / 2);
    for (Index g = 0; g < RowSlabs::slabs; ++g)
      EXPECT_LT(slabs.start(g + 1) - slabs.start(g), 2 * count / RowSlabs::slabs) << "slab " << g;
    for (Index phase = 1; phase < RowSlabs::phases - 1; ++phase)
      EXPECT_GT(slabs.start(slabs.first_group(phase) + 1), slabs.start(slabs.first_group(phase)))
          << "phase " << phase << " is not tested";
  }
}

TEST(RowSlabs, AllPointsInOnePlaceAndPointsNowhereAreNoTrouble) {
  Heap heap(2000, 3000, 2);
  std::ranges::fill(heap.x1, Vec3(1, 2, 3));
  EXPECT_EQ(RowSlabs(heap.vertices(), heap.x1).start(RowSlabs::groups), 3000);
  heap.x1[7].setConstant(std::numeric_limits<double>::quiet_NaN());
  heap.x1[8].setConstant(std::numeric_limits<double>::infinity());
  EXPECT_EQ(RowSlabs(heap.vertices(), heap.x1).start(RowSlabs::groups), 3000);
}

// What Gauss-Seidel aims at: x1 moves least in the norm of the masses, so that rows hold and only
// those that are just met push.
TEST(SatisfyRows, MeetsTheConditionsOfTheLeastMotion) {
  for (const Index count : {Index{300}, Index{2000}}) {  // one group; all phases
    Heap heap(6000, count, 3);
    for (ContactRow& row : heap.rows) row.friction = 0.0;
    const std::vector<Vec3> x = heap.met(4000, 1e-13);
    std::vector<Vec3> pushed(x.size(), Vec3::Zero());
    int pushing = 0;
    for (const ContactRow& row : heap.rows) {
      if (row.inverse_mass == 0.0) continue;
      const double slack = row.normal.dot(separation(row, x)) - row.target;
      EXPECT_GT(slack, -1e-10);
      EXPECT_GE(row.lambda, 0.0);
      if (row.lambda > 0.0) {
        EXPECT_LT(slack, 1e-10);
        ++pushing;
      }
      for (std::size_t k = 0; k < 4 && row.node[k] >= 0; ++k)
        pushed[row.node[k]] += row.share[k] * row.lambda * row.normal;
    }
    EXPECT_GT(pushing, count / 10);
    for (std::size_t i = 0; i < x.size(); ++i)
      ASSERT_LT((x[i] - heap.x1[i] - pushed[i]).norm(), 1e-12);
  }
}

TEST(SatisfyRows, FrictionStaysInItsConeAndMomentumIsKept) {
  Heap heap(3000, 5000, 4);
  std::erase_if(heap.rows, [&](const ContactRow& row) {
    return row.node[1] < 0 ||
           std::ranges::any_of(
               row.node, [&](Index node) { return heap.inverse_mass[node] == 0.0; });
  });
  const std::vector<Vec3> x = heap.met(20, 1e-7);
  Vec3 change = Vec3::Zero();
  double size = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    change += heap.mass[i] * (x[i] - heap.x1[i]);
    size += heap.mass[i] * (x[i] - heap.x1[i]).norm();
  }
  EXPECT_GT(size, 1e-3);
  EXPECT_LT(change.norm(), 1e-12 * size);
  int sliding = 0;
  for (const ContactRow& row : heap.rows) {
    EXPECT_LE(row.tangential.norm(), row.friction * row.lambda + 2e-8 / row.inverse_mass)
        << "changes of a tenth of 1e-7 are not made";
    EXPECT_NEAR(row.tangential.dot(row.normal), 0.0, 1e-12);
    sliding += row.tangential.norm() > 0.0;
  }
  EXPECT_GT(sliding, 100);
}

TEST(SatisfyRows, SameBitsForAnyNumberOfThreads) {
  std::vector<Vec3> first;
  const int before = thread_count();
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    Heap heap(4000, 9000, 5);
    const std::vector<Vec3> x = heap.met(12, 1e-7);
    if (first.empty()) first = x;
    EXPECT_TRUE(x == first) << threads << " threads";
  }
  set_thread_count(before);
}

}  // namespace
}  // namespace taut
