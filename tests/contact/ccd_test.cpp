#include "taut/contact/ccd.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "moving_pairs.h"
#include "taut/base/parallel.h"

namespace taut {

namespace {

using test::Corners;
using test::PairKind;

constexpr PairKind kinds[] = {PairKind::vertex_triangle, PairKind::edge_edge};

// Whole numbers in [-bound, bound].
Vec3 whole(std::mt19937& random, int bound) {
  std::uniform_int_distribution<int> any(-bound, bound);
  return Vec3(any(random), any(random), any(random));
}

Vec3 anywhere(std::mt19937& random, double bound) {
  std::uniform_real_distribution<double> any(-bound, bound);
  return Vec3(any(random), any(random), any(random));
}

// A pair that touches at t = eighth / 8 exactly: coordinates are multiples of 2^-12, so every
// number on the way is a double. The weights of the point of contact are multiples of 1/8 too, 0
// and 8 among them: corners, sides and inner points, the first and the last moment.
struct ExactContact {
  Corners corners;
  double time;
};

Vec3 weighted(int eighths, const Vec3& a, const Vec3& b) {
  return ((8 - eighths) * a + eighths * b) / 8.0;
}

ExactContact exact_contact(PairKind kind, std::mt19937& random, int motion) {
  std::uniform_int_distribution<int> eighths(0, 8);
  const int t = eighths(random), u = eighths(random), v = eighths(random);
  Corners x;
  for (int k = 0; k < 4; ++k) {
    x[k] = whole(random, 8);
    x[k + 4] = x[k] + whole(random, motion);
  }
  const auto at = [&](int k) { return weighted(t, x[k], x[k + 4]); };
  // Shifts the first shape (p, or a and b) such that it touches the second at t.
  Vec3 gap;
  if (kind == PairKind::vertex_triangle)
    gap = weighted(u, at(1), weighted(v, at(2), at(3))) - at(0);
  else
    gap = weighted(v, at(2), at(3)) - weighted(u, at(0), at(1));
  for (int k = 0; k < (kind == PairKind::vertex_triangle ? 1 : 2); ++k)
    x[k] += gap, x[k + 4] += gap;
  return {x, t / 8.0};
}

Corners scaled(Corners x, double scale, const Vec3& shift) {
  for (Vec3& corner : x) corner = scale * corner + shift;
  return x;
}

}  // namespace

TEST(Ccd, FindsEveryExactContact) {
  std::mt19937 random(1);
  for (const PairKind kind : kinds)
    for (const int motion : {0, 1, 3, 20})
      for (int k = 0; k < 5000; ++k) {
        const auto [corners, time] = exact_contact(kind, random, motion);
        for (const double scale : {1.0, 0x1p-60, 0x1p60, 0x1p-300}) {
          const Impact impact =
              test::impact_of(kind, scaled(corners, scale, Vec3::Zero()), {.tolerance = 0.0});
          ASSERT_TRUE(impact.hit) << "kind " << static_cast<int>(kind) << " motion " << motion
                                  << " query " << k << " scale " << scale;
          ASSERT_LE(impact.time, time);
        }
      }
}

// Far from the origin the corners are rounded already, so that they touch no more exactly; but
// those of 2^20 + multiples of 2^-12 are not.
TEST(Ccd, FindsExactContactsFarFromTheOrigin) {
  std::mt19937 random(2);
  for (const PairKind kind : kinds)
    for (int k = 0; k < 5000; ++k) {
      const auto [corners, time] = exact_contact(kind, random, 5);
      const Impact impact = test::impact_of(
          kind, scaled(corners, 1.0, Vec3(0x1p20, -0x1p20, 0x1p19)), {.tolerance = 0.0});
      ASSERT_TRUE(impact.hit);
      ASSERT_LE(impact.time, time);
    }
}

// Degenerate on purpose: flat motion in one plane, parallel and collinear edges, triangles and
// edges without size.
TEST(Ccd, FindsExactContactsOfDegenerateShapes) {
  std::mt19937 random(3);
  for (const PairKind kind : kinds)
    for (int k = 0; k < 20000; ++k) {
      auto [corners, time] = exact_contact(kind, random, 4);
      const int flat = k % 4;
      for (Vec3& corner : corners) {
        if (flat == 0) corner[2] = 0.0;                                 // all in a plane
        if (flat == 1) corner = Vec3(corner[0], 2 * corner[0], 0.0);    // all on a line
        if (flat == 2) corner = Vec3(corner[0], corner[1], corner[1]);  // in an oblique plane
        if (flat == 3) corner = Vec3(corner[0], 0.0, 0.0);              // along an axis
      }
      const Impact impact = test::impact_of(kind, corners, {.tolerance = 0.0});
      ASSERT_TRUE(impact.hit) << "kind " << static_cast<int>(kind) << " query " << k;
      ASSERT_LE(impact.time, time);
    }
}

TEST(Ccd, ContactAtTheStartIsAtTimeZero) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), p(0.25, 0.25, 0.0), up(0, 0, 1);
  EXPECT_EQ(vertex_triangle_impact(p, a, b, c, p + up, a, b, c, {}), (Impact{true, 0.0}));
  EXPECT_EQ(vertex_triangle_impact(p, a, b, c, p, a, b, c, {}), (Impact{true, 0.0}));
  EXPECT_FALSE(vertex_triangle_impact(p + up, a, b, c, p + up, a, b, c, {}).hit);
  EXPECT_FALSE(edge_edge_impact(a, b, a + up, c + up, a, b, a + up, c + up, {}).hit);
  EXPECT_EQ(edge_edge_impact(a, b, a, c, a, b, a, c, {}), (Impact{true, 0.0}));
}

TEST(Ccd, TimeOfAStraightFall) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), p(0.25, 0.25, 1.0), end(0.25, 0.25, -3.0);
  const CcdOptions options{.tolerance = 1e-12};
  const Impact impact = vertex_triangle_impact(p, a, b, c, end, a, b, c, options);
  EXPECT_TRUE(impact.hit);
  EXPECT_NEAR(impact.time, 0.25, 1e-12);
  EXPECT_LE(impact.time, 0.25);
  const Impact apart = vertex_triangle_impact(p, a, b, c, end, a, b, c,
                                              {.minimum_separation = 0.5, .tolerance = 1e-12});
  EXPECT_NEAR(apart.time, 0.125, 1e-12);
  EXPECT_LE(apart.time, 0.125);
  // From above it stops at 0.1 and so stays 0.1 away.
  EXPECT_FALSE(vertex_triangle_impact(p, a, b, c, Vec3(0.25, 0.25, 0.1), a, b, c,
                                      {.minimum_separation = 0.0999})
                   .hit);
  EXPECT_TRUE(vertex_triangle_impact(p, a, b, c, Vec3(0.25, 0.25, 0.1), a, b, c,
                                     {.minimum_separation = 0.1001})
                  .hit);
}

// Where a slower, independent bound on the distance leaves no doubt, the answer must be that, and
// until `time` nothing has met.
TEST(Ccd, AgreesWithTheDistanceInTime) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int hits = 0, clear = 0;
  for (const PairKind kind : kinds)
    for (const double motion : {0.05, 0.5, 5.0})
      for (int k = 0; k < 3000; ++k) {
        Corners x;
        for (int i = 0; i < 4; ++i)
          x[i] = anywhere(random, 1.0), x[i + 4] = x[i] + anywhere(random, motion);
        CcdOptions options;
        options.minimum_separation = k % 3 == 0 ? 0.0 : 0.1 * uniform(random);
        const Impact impact = test::impact_of(kind, x, options);
        const long double separation = options.minimum_separation;
        if (impact.hit) {
          ++hits;
          ASSERT_LE(test::distance_at(kind, x, impact.time),
                    separation + options.tolerance * 1.001L + 1e-14L);
          if (impact.time > 0.0) {
            ASSERT_TRUE(test::surely_above(kind, x, separation, 0.0L,
                                           static_cast<long double>(impact.time) * (1 - 1e-6L)));
          }
        } else {
          ++clear;
          ASSERT_EQ(impact.time, 1.0);
          ASSERT_TRUE(test::surely_above(kind, x, separation, 0.0L, 1.0L));
        }
      }
  EXPECT_GT(hits, 500);
  EXPECT_GT(clear, 500);
}

// Two edges that turn past each other, almost parallel all the time, at a given distance: neither
// missed nor a false alarm.
TEST(Ccd, ParallelEdgesPassClosely) {
  for (const double gap : {1e-3, 1e-6, 1e-8}) {
    for (const double turn : {0.0, 1e-12, 1e-6, 0.1}) {
      const auto edge_at = [&](double y, double z, double angle) {
        const Vec3 along(std::cos(angle), std::sin(angle), 0.0), centre(0.0, y, z);
        return std::array<Vec3, 2>{centre - along, centre + along};
      };
      const auto [c, d] = edge_at(0.0, 0.0, 0.0);
      for (const double z : {gap, -gap, 0.0}) {
        const auto [a0, b0] = edge_at(0.5, z, turn);
        const auto [a1, b1] = edge_at(-0.5, z, -turn);
        const Impact impact = edge_edge_impact(a0, b0, c, d, a1, b1, c, d, {});
        EXPECT_EQ(impact.hit, z == 0.0) << "gap " << gap << " turn " << turn << " z " << z;
      }
    }
  }
}

// Past a corner or a side of the triangle, and just over it, by less and less.
TEST(Ccd, NearMissesAreToldFromHits) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  for (double gap = 0.1; gap > 1e-9; gap /= 7.0) {
    const auto passes = [&](const Vec3& start, const Vec3& end) {
      return !vertex_triangle_impact(start, a, b, c, end, a, b, c, {}).hit;
    };
    EXPECT_TRUE(passes({0.3, -gap, 1.0}, {0.3, -gap, -1.0})) << gap;
    EXPECT_FALSE(passes({0.3, gap, 1.0}, {0.3, gap, -1.0})) << gap;
    EXPECT_TRUE(passes({-gap, -gap, 0.5}, {-gap, -gap, -0.7})) << gap;
    EXPECT_TRUE(passes({-1.0, 0.2, gap}, {1.0, 0.3, gap})) << gap;
    EXPECT_TRUE(passes({-1.0, 0.2, 0.3}, {1.0, 0.3, gap})) << gap;
    EXPECT_FALSE(passes({0.05, 0.2, 0.3}, {0.1, 0.3, -gap})) << gap;
  }
}

TEST(Ccd, GivesUpConservatively) {
  std::mt19937 random(5);
  for (const PairKind kind : kinds)
    for (int k = 0; k < 500; ++k) {
      Corners x;
      for (Vec3& corner : x) corner = anywhere(random, 1.0);
      const Impact full = test::impact_of(kind, x, {});
      double before = 0.0;
      for (const int checks : {0, 1, 2, 5, 20}) {
        const Impact capped = test::impact_of(kind, x, {.max_checks = checks});
        if (!capped.hit) {
          EXPECT_FALSE(full.hit);
          continue;
        }
        EXPECT_LE(capped.time, full.time);
        EXPECT_GE(capped.time, before);
        before = capped.time;
      }
    }
}

TEST(Ccd, WhatIsNotFiniteIsAHit) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  for (const PairKind kind : kinds)
    for (int corner = 0; corner < 8; ++corner)
      for (const double bad : {nan, infinity, -infinity, 1e305}) {
        Corners x{Vec3(0, 0, 9), Vec3(1, 0, 9), Vec3(0, 1, 0), Vec3(1, 1, 0),
                  Vec3(0, 0, 9), Vec3(1, 0, 9), Vec3(0, 1, 0), Vec3(1, 1, 0)};
        x[corner][corner % 3] = bad;
        EXPECT_EQ(test::impact_of(kind, x, {}), (Impact{true, 0.0}));
      }
}

TEST(Ccd, ListsAreAnsweredPairByPairForAnyThreadCount) {
  std::mt19937 random(6);
  constexpr Index triangles = 500;
  std::vector<Vec3> x0, x1;
  std::vector<Triangle> list;
  for (Index t = 0; t < triangles; ++t) {
    list.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    for (int k = 0; k < 3; ++k)
      x0.push_back(anywhere(random, 1.0)), x1.push_back(x0.back() + anywhere(random, 0.5));
  }
  const SurfacePart part{3 * triangles, list, false};
  const CollisionSurface surface = join_surfaces({&part, 1});
  std::vector<VertexTriangle> vertex_pairs;
  std::vector<EdgeEdge> edge_pairs;
  for (Index k = 0; k < 5000; ++k) {
    vertex_pairs.push_back({3 * (k % triangles), (k + 1 + k / triangles) % triangles});
    edge_pairs.push_back({k % 700, 700 + k % 800});
  }
  const int threads = thread_count();
  std::vector<PairImpact> vertex_hits, edge_hits, again;
  set_thread_count(1);
  find_impacts(surface, x0, x1, vertex_pairs, {}, vertex_hits);
  find_impacts(surface, x0, x1, edge_pairs, {}, edge_hits);
  EXPECT_GT(vertex_hits.size(), 20u);
  EXPECT_GT(edge_hits.size(), 50u);
  for (const int count : {2, 5}) {
    set_thread_count(count);
    find_impacts(surface, x0, x1, vertex_pairs, {}, again);
    EXPECT_EQ(again, vertex_hits);
    find_impacts(surface, x0, x1, edge_pairs, {}, again);
    EXPECT_EQ(again, edge_hits);
  }
  set_thread_count(threads);
  auto hit = vertex_hits.begin();
  for (Index k = 0; k < 5000; ++k) {
    const auto [p, t] = vertex_pairs[k];
    const Impact alone = vertex_triangle_impact(x0[p], x0[3 * t], x0[3 * t + 1], x0[3 * t + 2],
                                                x1[p], x1[3 * t], x1[3 * t + 1], x1[3 * t + 2], {});
    const bool listed = hit != vertex_hits.end() && hit->pair == k;
    EXPECT_EQ(alone.hit, listed);
    if (listed) {
      EXPECT_EQ(hit->time, alone.time);
      ++hit;
    }
  }
}

}  // namespace taut
