#include "taut/contact/detection/clear_pairs.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>

#include "moving_pairs.h"
#include "taut/contact/collision_pair.h"
#include "taut/contact/intersection.h"
#include "taut/mesh/grid.h"
#include "triangle_soups.h"

namespace taut {

namespace {

using detail::PairCorners;
using test::Corners;
using test::PairKind;

constexpr PairKind kinds[] = {PairKind::vertex_triangle, PairKind::edge_edge};

std::vector<std::uint8_t> flags_of(bool single, const std::vector<PairCorners>& corners, bool edges,
                                   const std::vector<Vec3>& x0, const std::vector<Vec3>& x1,
                                   double distance) {
  std::vector<std::uint8_t> flags(corners.size(), 255);
  const auto count = static_cast<Index>(corners.size());
  if (single) {
    detail::FloatWays ways;
    ways.set(x0, x1);
    ways.find_clear(corners.data(), count, edges, distance, flags.data());
  } else {
    detail::find_clear(corners.data(), count, edges, x0.data(), x1.data(), distance, flags.data());
  }
  return flags;
}

std::vector<std::uint8_t> flags_of(bool single, PairKind kind, const std::vector<Corners>& pairs,
                                   double distance) {
  std::vector<Vec3> x0, x1;
  std::vector<PairCorners> corners;
  for (const Corners& x : pairs) {
    const Index first = static_cast<Index>(x0.size());
    corners.push_back({first, first + 1, first + 2, first + 3});
    x0.insert(x0.end(), x.begin(), x.begin() + 4);
    x1.insert(x1.end(), x.begin() + 4, x.end());
  }
  return flags_of(single, corners, kind == PairKind::edge_edge, x0, x1, distance);
}

Corners random_pair(std::mt19937& random, double apart, double motion) {
  Corners x;
  const Vec3 shift = test::anywhere(random, apart);
  for (int k = 0; k < 4; ++k) {
    x[k] = test::anywhere(random, 1.0) + (k < 2 ? shift : Vec3(Vec3::Zero()));
    x[k + 4] = x[k] + test::anywhere(random, motion);
  }
  return x;
}

// In double and in single precision.
class ClearPairs : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Precisions, ClearPairs, testing::Bool(),
                         [](const auto& single) { return single.param ? "single" : "double"; });

}  // namespace

TEST_P(ClearPairs, AreFurtherApartAllTheTime) {
  std::mt19937 random(1);
  for (const PairKind kind : kinds)
    for (const double motion : {0.0, 0.1, 1.0}) {
      std::vector<Corners> pairs;
      // not a multiple of the lanes
      for (int k = 0; k < 1001; ++k) pairs.push_back(random_pair(random, 1.5, motion));
      constexpr double distance = 0.2;
      const std::vector<std::uint8_t> flags = flags_of(GetParam(), kind, pairs, distance);
      int clear = 0;
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        ASSERT_LT(flags[k], 4);
        if (flags[k] & detail::clear_at_start) {
          EXPECT_GT(test::distance_at(kind, pairs[k], 0), distance);
        }
        if (!(flags[k] & detail::clear_throughout)) continue;
        ++clear;
        for (int t = 0; t <= 32; ++t)
          EXPECT_GT(test::distance_at(kind, pairs[k], t / 32.0L), distance) << k;
      }
      EXPECT_GT(clear, 100) << motion;
    }
}

// Vertices on a face, edges that cross: exactly `gap` apart at one end, in numbers that are exact.
// Turned and scaled by powers of two and swapped axes, they stay so.
TEST_P(ClearPairs, NoneIsClearOfTheDistanceItHas) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> any(-8, 8), exponent(-40, 40);
  for (const PairKind kind : kinds)
    for (int trial = 0; trial < 3000; ++trial) {
      const double scale = std::ldexp(1.0, exponent(random)), gap = scale * std::abs(any(random));
      const auto flat = [&](double z) { return Vec3(scale * any(random), scale * any(random), z); };
      Corners x;
      if (kind == PairKind::vertex_triangle) {
        x = {Vec3(0, 0, gap), flat(0), flat(0), Vec3::Zero()};
        x[3] = -x[1] - x[2];  // the vertex is above the centroid
      } else {
        x = {flat(gap), Vec3::Zero(), flat(0), Vec3::Zero()};
        x[1] = Vec3(-x[0][0], -x[0][1], gap);
        x[3] = -x[2];
      }
      const bool touch_at_end = any(random) > 0;
      for (int k = 0; k < 4; ++k) x[k + 4] = x[k];
      // At the other end the first shape is further off.
      for (int k = 0; k < (kind == PairKind::vertex_triangle ? 1 : 2); ++k)
        x[k + (touch_at_end ? 0 : 4)][2] += 5.0 * scale;
      const int turn = any(random) & 1;
      for (Vec3& corner : x)
        if (turn) corner = Vec3(corner[1], corner[2], corner[0]);
      EXPECT_FALSE(flags_of(GetParam(), kind, {x}, gap)[0] & detail::clear_throughout);
      if (!touch_at_end) {
        EXPECT_FALSE(flags_of(GetParam(), kind, {x}, gap)[0] & detail::clear_at_start);
      }
    }
}

TEST_P(ClearPairs, NumbersThatAreNotFiniteAreNotClear) {
  std::mt19937 random(3);
  for (const PairKind kind : kinds)
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200})
      for (int corner = 0; corner < 8; ++corner) {
        Corners x = random_pair(random, 0.0, 0.1);
        // far apart without the bad number
        for (int k = 0; k < 2; ++k) x[k][0] += 100.0, x[k + 4][0] += 100.0;
        if (std::isfinite(bad)) x[0] = x[4] = x[2] = x[6];  // huge, and touching
        x[corner][1] = bad;
        if (!std::isfinite(bad)) {
          EXPECT_FALSE(flags_of(GetParam(), kind, {x}, 0.1)[0] & detail::clear_throughout);
        }
      }
  Corners tiny;
  for (Vec3& corner : tiny) corner = test::anywhere(random, 1e-160);
  for (const PairKind kind : kinds) EXPECT_EQ(flags_of(GetParam(), kind, {tiny}, 1e-150)[0], 0);
}

// Far from the origin, where floats are a thousandth of the distance apart and more, and with ends
// that move far.
TEST(ClearPairsInSingle, AreFurtherApartWhereverTheyAre) {
  std::mt19937 random(4);
  for (const PairKind kind : kinds)
    for (const double size : {1.0, 100.0, 1e4}) {
      std::vector<Corners> pairs;
      for (int k = 0; k < 1000; ++k) {
        Corners x = random_pair(random, 1.5, 0.3);
        const Vec3 place = 1e6 * Vec3(1, 2, 3) + test::anywhere(random, size);
        for (Vec3& corner : x) corner = 0.01 * corner + place;
        pairs.push_back(x);
      }
      constexpr double distance = 0.002;
      const std::vector<std::uint8_t> flags = flags_of(true, kind, pairs, distance),
                                      exact = flags_of(false, kind, pairs, distance);
      int missed = 0, clear = 0;
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        clear += exact[k] == (detail::clear_at_start | detail::clear_throughout);
        missed += flags[k] != exact[k];
        if (flags[k] & detail::clear_at_start) {
          EXPECT_GT(test::distance_at(kind, pairs[k], 0), distance);
        }
        if (!(flags[k] & detail::clear_throughout)) continue;
        for (int t = 0; t <= 8; ++t)
          EXPECT_GT(test::distance_at(kind, pairs[k], t / 8.0L), distance) << k;
      }
      EXPECT_GT(clear, 100);
      if (size <= 1.0) {
        EXPECT_LT(missed, 5) << "it is as good where the cloth is a thousand times its thickness";
      }
    }
}

namespace {

using detail::SegmentTriangle;

std::vector<std::uint8_t> apart_flags(const std::vector<SegmentTriangle>& pairs,
                                      const std::vector<Vec3>& x) {
  std::vector<std::uint8_t> flags(pairs.size(), 255);
  detail::FloatWays positions;
  positions.set(x, x);
  positions.find_apart(pairs.data(), static_cast<Index>(pairs.size()), flags.data());
  return flags;
}

bool meets(const SegmentTriangle& pair, const std::vector<Vec3>& x) {
  return segment_meets_triangle(x[pair[0]], x[pair[1]], x[pair[2]], x[pair[3]], x[pair[4]]).meets;
}

}  // namespace

TEST(SegmentsApartFromTriangles, DoNotMeetThem) {
  std::mt19937 random(5);
  for (const double size : {1.0, 1e-3})
    for (const double place : {0.0, 1.0, 1e3}) {
      std::vector<Vec3> x;
      std::vector<SegmentTriangle> pairs;
      for (int k = 0; k < 4001; ++k) {
        const Vec3 shift = place * Vec3(1, 2, 3) + test::anywhere(random, place),
                   away = test::anywhere(random, size);
        const auto first = static_cast<Index>(x.size());
        pairs.push_back({first, first + 1, first + 2, first + 3, first + 4});
        for (int c = 0; c < 5; ++c)
          x.push_back(shift + test::anywhere(random, size) + (c < 2 ? away : Vec3(Vec3::Zero())));
      }
      const std::vector<std::uint8_t> flags = apart_flags(pairs, x);
      int apart = 0, meeting = 0;
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        const bool meet = meets(pairs[k], x);
        meeting += meet;
        ASSERT_LE(flags[k], 1);
        apart += flags[k];
        EXPECT_FALSE(flags[k] && meet) << k;
      }
      EXPECT_GT(meeting, 100);
      if (size > 1e-4 * place) {
        EXPECT_GT(apart, (4001 - meeting) * 3 / 4) << size << " " << place;
      }
    }
}

// An end on the face, on a side, on a corner; a segment across a side or in the triangle's plane:
// in numbers that are exact.
TEST(SegmentsApartFromTriangles, NoneThatTouchesIsApart) {
  std::mt19937 random(6);
  std::uniform_int_distribution<int> any(-8, 8), exponent(-30, 30), kinds(0, 3);
  for (int trial = 0; trial < 5000; ++trial) {
    const double scale = std::ldexp(1.0, exponent(random));
    const auto whole = [&] { return Vec3(any(random), any(random), any(random)); };
    const Vec3 c = 4.0 * whole(), d = 4.0 * whole(), e = 4.0 * whole();
    Vec3 a;  // on the triangle
    switch (kinds(random)) {
      case 0:
        a = 0.5 * c + 0.25 * d + 0.25 * e;
        break;
      case 1:
        a = 0.75 * c + 0.25 * e;
        break;
      case 2:
        a = d;
        break;
      default:
        a = 0.5 * (d + e);
        break;
    }
    const Vec3 towards = kinds(random) == 0 ? Vec3(c - d) : whole();
    const bool across = kinds(random) == 0;
    std::vector<Vec3> x{a, a + towards, c, d, e};
    if (across) x[0] = a - towards;
    for (Vec3& corner : x) corner *= scale;
    const SegmentTriangle pair{0, 1, 2, 3, 4};
    ASSERT_TRUE(meets(pair, x));
    EXPECT_EQ(apart_flags({pair}, x)[0], 0);
  }
}

TEST(SegmentsApartFromTriangles, NumbersThatAreNotFiniteAreNotApart) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    for (int corner = 0; corner < 5; ++corner) {
      std::vector<Vec3> x{{0, 0, 9}, {1, 0, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
      ASSERT_EQ(apart_flags({{0, 1, 2, 3, 4}}, x)[0], 1);
      x[corner][1] = bad;
      EXPECT_EQ(apart_flags({{0, 1, 2, 3, 4}}, x)[0], 0);
    }
}

// What it is for: neighbours in smooth cloth need no closest points.
TEST_P(ClearPairs, NeighboursInASmoothSheetAreClear) {
  TriangleMesh sheet = make_grid({20, 20});
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& x : sheet.positions)
    x = turn * Vec3(x[0], x[1], x[2] + 0.2 * x[0] * x[0] + 0.1 * x[1] * x[0]);
  const SurfacePart part{static_cast<Index>(sheet.positions.size()), sheet.triangles, false};
  const CollisionSurface surface = join_surfaces({&part, 1});
  BroadPhase broad_phase(surface, sheet.positions);
  const double distance = 0.1 / 19;
  broad_phase.refit(sheet.positions, sheet.positions, distance);
  const auto share_clear = [&](const auto& pairs, bool edges) {
    std::vector<PairCorners> corners;
    for (const auto& pair : pairs) corners.push_back(pair_of(surface, pair).node);
    const std::vector<std::uint8_t> flags =
        flags_of(GetParam(), corners, edges, sheet.positions, sheet.positions, distance);
    EXPECT_GT(corners.size(), 100u);
    return static_cast<double>(
               std::ranges::count(flags, detail::clear_at_start | detail::clear_throughout)) /
           double(flags.size());
  };
  std::vector<VertexTriangle> vertex_triangle;
  std::vector<EdgeEdge> edge_edge;
  broad_phase.find_vertex_triangle(vertex_triangle);
  broad_phase.find_edge_edge(edge_edge);
  EXPECT_GT(share_clear(vertex_triangle, false), 0.99);
  EXPECT_GT(share_clear(edge_edge, true), 0.97);

  std::vector<EdgeTriangle> edge_triangle;
  broad_phase.find_edge_triangle(edge_triangle);
  std::vector<SegmentTriangle> pairs;
  for (const auto& [edge, triangle] : edge_triangle) {
    const EdgeVertices& e = surface.edges[edge];
    const Triangle& t = surface.triangles[triangle];
    pairs.push_back({e[0], e[1], t[0], t[1], t[2]});
  }
  EXPECT_GT(pairs.size(), 100u);
  EXPECT_GT(static_cast<double>(std::ranges::count(apart_flags(pairs, sheet.positions), 1)) /
                double(pairs.size()),
            0.99);
}

}  // namespace taut
