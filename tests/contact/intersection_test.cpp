#include "taut/contact/intersection.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>
#include <set>

#include "independent_judge.h"
#include "taut/base/parallel.h"
#include "taut/contact/ccd.h"
#include "triangle_soups.h"

namespace taut {

namespace {

using test::make_soup;
using test::Soup;

Vec3 grid_point(std::mt19937& random, int bound) {
  std::uniform_int_distribution<int> any(-bound, bound);
  return Vec3(any(random), any(random), any(random));
}

bool has_area(const Vec3& c, const Vec3& d, const Vec3& e) {
  return (d - c).cross(e - c) != Vec3::Zero();
}

// Pairs of triangles without a common vertex that have an edge of one through the other, from
// Taut's list.
std::vector<std::array<Index, 2>> triangle_pairs(const CollisionSurface& surface,
                                                 const std::vector<Intersection>& intersections) {
  std::set<std::array<Index, 2>> pairs;
  for (const Intersection& i : intersections) {
    const auto [a, b] = surface.edges[i.edge];
    const Triangle& t = surface.triangles[i.triangle];
    for (Index s = 0; s < surface.triangle_count(); ++s) {
      const Triangle& other = surface.triangles[s];
      const auto holds = [](const Triangle& triangle, Index v) {
        return std::ranges::find(triangle, v) != triangle.end();
      };
      if (!holds(other, a) || !holds(other, b)) continue;
      if (std::ranges::any_of(other, [&](Index v) { return holds(t, v); })) continue;
      pairs.insert({std::min(s, i.triangle), std::max(s, i.triangle)});
    }
  }
  return {pairs.begin(), pairs.end()};
}

void expect_as_judged(const Soup& soup) {
  BroadPhase broad_phase(soup.surface, soup.x0);
  const auto found = triangle_pairs(soup.surface, find_intersections(broad_phase, soup.x0));
  EXPECT_EQ(found,
            test::intersecting_triangles(soup.x0, soup.surface.triangles, soup.surface.is_solid));
}

}  // namespace

// Small whole numbers: most cases touch, lie in one plane or on one line.
TEST(Intersection, SegmentsAndTrianglesAsJudgedByCgal) {
  if (!test::judge_available()) GTEST_SKIP() << test::no_judge;
  std::mt19937 random(11);
  int met = 0, judged = 0;
  for (const int bound : {1, 2, 4})
    for (int k = 0; k < 30000; ++k) {
      Vec3 x[5];
      for (Vec3& p : x) p = grid_point(random, bound);
      if (k % 3 == 0)
        for (Vec3& p : x) p[2] = p[0] + p[1];  // all in a plane
      if (x[0] == x[1] || !has_area(x[2], x[3], x[4])) continue;
      const bool expected = test::judge_segment_triangle(x[0], x[1], x[2], x[3], x[4]);
      ASSERT_EQ(segment_meets_triangle(x[0], x[1], x[2], x[3], x[4]).meets, expected)
          << "bound " << bound << " query " << k;
      met += expected;
      ++judged;
    }
  EXPECT_GT(met, 5000);
  EXPECT_GT(judged - met, 5000);
}

// Corners within a few units in the last place of the triangle's plane and sides, where the
// floating-point value has no digit left.
TEST(Intersection, DecidesWithinRoundingAsCgalDoes) {
  if (!test::judge_available()) GTEST_SKIP() << test::no_judge;
  std::mt19937 random(12);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::uniform_int_distribution<int> units(-2, 2);
  int met = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 c = test::anywhere(random, 1.0), d = test::anywhere(random, 1.0),
               e = test::anywhere(random, 1.0);
    // every other one at the side d e
    const double v = uniform(random), w = k % 2 == 0 ? 1.0 - v : (1.0 - v) * uniform(random);
    Vec3 a = (1.0 - v - w) * c + v * d + w * e;
    for (int i = 0; i < 3; ++i) a[i] += units(random) * 0x1p-53;
    const Vec3 b =
        k % 3 == 0 ? test::anywhere(random, 1.0) : Vec3(2.0 * a - (0.2 * c + 0.3 * d + 0.5 * e));
    const bool expected = test::judge_segment_triangle(a, b, c, d, e);
    ASSERT_EQ(segment_meets_triangle(a, b, c, d, e).meets, expected) << k;
    met += expected;
  }
  EXPECT_GT(met, 2000);
  EXPECT_LT(met, 18000);
}

// The same within one plane, where the signs of the projections decide.
TEST(Intersection, DecidesWithinRoundingInAPlane) {
  if (!test::judge_available()) GTEST_SKIP() << test::no_judge;
  std::mt19937 random(14);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::uniform_int_distribution<int> units(-2, 2);
  int met = 0;
  for (int k = 0; k < 20000; ++k) {
    const int axis = k % 3;
    const auto in_plane = [&] {
      Vec3 x = test::anywhere(random, 1.0);
      x[axis] = 0.3;
      return x;
    };
    const Vec3 c = in_plane(), d = in_plane(), e = in_plane(), outside = in_plane();
    // From a point next to a side onwards, along it or away from the middle; so it meets the
    // triangle there or nowhere.
    const double share = 0.5 + 0.4 * uniform(random);
    Vec3 a = (1.0 - share) * d + share * e;
    for (int i = 0; i < 3; ++i)
      if (i != axis) a[i] += units(random) * 0x1p-53;
    Vec3 b = k % 2 == 0 ? Vec3(a + (a - c)) : outside;
    a[axis] = b[axis] = 0.3;
    const bool expected = test::judge_segment_triangle(a, b, c, d, e);
    ASSERT_EQ(segment_meets_triangle(a, b, c, d, e).meets, expected) << k;
    met += expected;
  }
  EXPECT_GT(met, 4000);
  EXPECT_LT(met, 16000);
}

TEST(Intersection, SurfacesAsJudgedByCgal) {
  if (!test::judge_available()) GTEST_SKIP() << test::no_judge;
  expect_as_judged(make_soup(21, 20, 15, 40, 0.0, 0.0));
  expect_as_judged(make_soup(22, 20, 15, 40, 0.03, 0.0));
  expect_as_judged(make_soup(23, 10, 9, 100, 0.3, 0.0));
  Soup flat = make_soup(24, 10, 9, 40, 0.1, 0.0);
  for (Vec3& x : flat.x0)
    x = Vec3(std::round(8 * x[0]), std::round(8 * x[1]), std::round(8 * x[2]));
  std::erase_if(flat.surface.triangles, [&](const Triangle& t) {
    return !has_area(flat.x0[t[0]], flat.x0[t[1]], flat.x0[t[2]]);
  });
  flat.surface.edges = unique_edges(flat.surface.triangles);
  expect_as_judged(flat);
}

// What CGAL does not decide: shapes without area or length.
TEST(Intersection, DegenerateShapes) {
  const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const auto meets = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    const Meeting meeting = segment_meets_triangle(a, b, c, d, e);
    EXPECT_TRUE(!meeting.meets || meeting.touching);
    return meeting.meets;
  };
  EXPECT_TRUE(meets(-x, x, -y, o, y));  // a triangle that is a segment, crossed
  EXPECT_TRUE(meets(-x, x, -y, y, 0.5 * y));
  EXPECT_FALSE(meets(-x, x, -y + z, o + z, y + z));    // passed above
  EXPECT_FALSE(meets(x, 2 * x, -y, o, y));             // beside it
  EXPECT_TRUE(meets(o, 2 * x, x, 3 * x, 4 * x));       // on its line, overlapping
  EXPECT_FALSE(meets(o, 2 * x, 3 * x, 4 * x, 5 * x));  // on its line, before it
  EXPECT_FALSE(meets(o, x + y + z, 2 * (x + y + z), 3 * (x + y + z), 4 * (x + y + z)));
  EXPECT_TRUE(meets(o, x + y + z, x + y + z, 3 * (x + y + z), 4 * (x + y + z)));
  EXPECT_TRUE(meets(-x, x, o, o, o));  // a triangle that is a point
  EXPECT_FALSE(meets(-x, x, y, y, y));
  EXPECT_TRUE(meets(o, o, o, o, o));
  EXPECT_FALSE(meets(o, o, z, z, z));
  EXPECT_TRUE(meets(0.25 * (x + y), 0.25 * (x + y), o, x, y));  // a segment that is a point
  EXPECT_TRUE(meets(0.5 * (x + y), 0.5 * (x + y), o, x, y));
  EXPECT_FALSE(meets(x + y, x + y, o, x, y));
  EXPECT_FALSE(meets(0.25 * (x + y) + z, 0.25 * (x + y) + z, o, x, y));
}

TEST(Intersection, TellsCrossingFromTouching) {
  const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), inside(0.25, 0.25, 0.0);
  EXPECT_FALSE(segment_meets_triangle(inside - z, inside + z, o, x, y).touching);
  EXPECT_TRUE(segment_meets_triangle(inside - z, inside + z, o, x, y).meets);
  EXPECT_TRUE(segment_meets_triangle(inside, inside + z, o, x, y).touching);
  EXPECT_TRUE(segment_meets_triangle(0.5 * x - z, 0.5 * x + z, o, x, y).touching);
  EXPECT_TRUE(segment_meets_triangle(inside, 5 * inside, o, x, y).touching);
  EXPECT_FALSE(segment_meets_triangle(inside + 1e-300 * z, inside + z, o, x, y).meets);
}

TEST(Intersection, NamesTheFacesOfTwoCrossedSheets) {
  // One triangle pierces another from below; a third is far away, a solid crosses a solid.
  const std::vector<Triangle> three{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}, two{{0, 1, 2}, {3, 4, 5}};
  const SurfacePart parts[]{{9, three, false}, {6, two, true}};
  const CollisionSurface surface = join_surfaces(parts);
  std::vector<Vec3> x{{0, 0, 0},   {4, 0, 0},  {0, 4, 0},  {1, 1, -1}, {1, 1, 1},
                      {9, 9, 0.5}, {50, 0, 0}, {51, 0, 0}, {50, 1, 0}};
  for (int v = 0; v < 6; ++v) x.push_back(x[v] + Vec3(100, 0, 0));
  BroadPhase broad_phase(surface, x);
  const auto found = find_intersections(broad_phase, x);
  ASSERT_EQ(found.size(), 2u);
  // the long side of the first in the second
  EXPECT_EQ(surface.edges[found[0].edge], (EdgeVertices{1, 2}));
  EXPECT_EQ(found[0].triangle, 1);
  EXPECT_EQ(surface.edges[found[1].edge], (EdgeVertices{3, 4}));
  EXPECT_EQ(found[1].triangle, 0);
  EXPECT_FALSE(found[1].touching);
}

TEST(Intersection, SameListForAnyThreadCount) {
  const Soup soup = make_soup(25, 40, 40, 200, 0.03, 0.0);
  BroadPhase broad_phase(soup.surface, soup.x0);
  const int threads = thread_count();
  set_thread_count(1);
  const auto alone = find_intersections(broad_phase, soup.x0);
  EXPECT_GT(alone.size(), 100u);
  for (const int count : {2, 5}) {
    set_thread_count(count);
    EXPECT_EQ(find_intersections(broad_phase, soup.x0), alone);
  }
  set_thread_count(threads);
}

// A triangle at rest is met by a moving vertex exactly if the vertex's path meets it; an edge at
// rest by an edge that is moved without turning exactly if it meets the parallelogram in between.
// Here detection and the exact decisions check each other within rounding.
TEST(Intersection, PathsWithinRoundingAreNotMissedByCcd) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::uniform_int_distribution<int> units(-3, 3);
  // so that sums below are exact
  const auto rounded = [](Vec3 x) { return Vec3((x * 0x1p40).array().round() * 0x1p-40); };
  int met = 0, alarms = 0;
  constexpr int queries = 20000;
  for (int k = 0; k < queries; ++k) {
    const Vec3 c = rounded(test::anywhere(random, 1.0)), d = rounded(test::anywhere(random, 1.0)),
               e = rounded(test::anywhere(random, 1.0));
    const double v = uniform(random), w = k % 2 == 0 ? 1.0 - v : (1.0 - v) * uniform(random);
    Vec3 near = rounded((1.0 - v - w) * c + v * d + w * e);
    for (int i = 0; i < 3; ++i) near[i] += units(random) * 0x1p-40;
    const Vec3 far = rounded(test::anywhere(random, 1.0));
    const Vec3 p0 = k % 3 == 0 ? far : Vec3(2.0 * near - far), p1 = k % 3 == 0 ? near : far;
    const CcdOptions options{.tolerance = 0.0};
    const bool path = segment_meets_triangle(p0, p1, c, d, e).meets;
    const bool hit = vertex_triangle_impact(p0, c, d, e, p1, c, d, e, options).hit;
    ASSERT_TRUE(hit || !path) << "vertex " << k;
    met += path;
    alarms += hit && !path;

    // The edge from p0 to p1 stays; the edge c d moves by the way from c to e.
    const Vec3 way = e - c;
    const bool swept = segment_meets_triangle(p0, p1, c, d, d + way).meets ||
                       segment_meets_triangle(p0, p1, c, d + way, c + way).meets;
    const bool edge_hit = edge_edge_impact(p0, p1, c, d, p0, p1, c + way, d + way, options).hit;
    ASSERT_TRUE(edge_hit || !swept) << "edge " << k;
    alarms += edge_hit && !swept;
  }
  EXPECT_GT(met, queries / 8);
  EXPECT_LT(met, queries - queries / 8);
  RecordProperty("false_alarms", alarms);
  EXPECT_LT(alarms, queries / 50);
}

}  // namespace taut
