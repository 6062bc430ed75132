#include "taut/contact/broad_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "taut/base/parallel.h"
#include "triangle_soups.h"

namespace taut {

namespace {

using test::make_soup;
using test::Soup;

// The greatest gap that the boxes of two sets of corners keep along an axis, on one side, at both
// ends, m; negative where there is none.
double gap_between(const Soup& soup, std::span<const Index> a, std::span<const Index> b) {
  const auto least_difference = [&](const std::vector<Vec3>& x, std::span<const Index> upper,
                                    std::span<const Index> lower, int i) {
    double gap = std::numeric_limits<double>::infinity();
    for (const Index u : upper)
      for (const Index l : lower) gap = std::min(gap, x[u][i] - x[l][i]);
    return gap;
  };
  double gap = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i)
    for (const auto& [upper, lower] : {std::pair(a, b), std::pair(b, a)})
      gap = std::max(gap, std::min(least_difference(soup.x0, upper, lower, i),
                                   least_difference(soup.x1, upper, lower, i)));
  return gap;
}

bool share(std::span<const Index> a, std::span<const Index> b) {
  return std::ranges::any_of(a, [&](Index v) { return std::ranges::find(b, v) != b.end(); });
}

// `found` (sorted) against all pairs: those within the margin must be there, those far beyond its
// rounding must not.
template <class Pair, class First, class Second>
void expect_pairs(const Soup& soup, double margin, std::vector<Pair> found, Index firsts,
                  Index seconds, const First& first, const Second& second, bool ordered,
                  std::span<const std::uint8_t> moved) {
  std::ranges::sort(found);
  EXPECT_EQ(std::ranges::adjacent_find(found), found.end()) << "a pair is reported twice";
  std::size_t matched = 0;
  for (Index i = 0; i < firsts; ++i)
    for (Index j = ordered ? i + 1 : 0; j < seconds; ++j) {
      const std::span<const Index> a = first(i), b = second(j);
      const auto is_moved = [&](Index v) { return moved.empty() || moved[v] != 0; };
      const bool wanted = !share(a, b) &&
                          !(soup.surface.is_solid[a[0]] && soup.surface.is_solid[b[0]]) &&
                          (std::ranges::any_of(a, is_moved) || std::ranges::any_of(b, is_moved));
      const bool listed = std::ranges::binary_search(found, Pair{i, j});
      matched += listed;
      if (!wanted) {
        ASSERT_FALSE(listed);
        continue;
      }
      const double gap = gap_between(soup, a, b);
      if (gap <= margin) {
        ASSERT_TRUE(listed) << i << " " << j << " gap " << gap;
      }
      if (gap > margin + 1e-5 * (1.0 + margin)) {
        ASSERT_FALSE(listed) << i << " " << j << " gap " << gap;
      }
    }
  EXPECT_EQ(matched, found.size()) << "a pair is out of range";
}

void check_against_all_pairs(const Soup& soup, double margin,
                             std::span<const std::uint8_t> moved = {}) {
  const CollisionSurface& surface = soup.surface;
  BroadPhase broad_phase(surface, soup.x0);
  if (moved.empty()) {
    broad_phase.refit(soup.x0, soup.x1, margin);
  } else {
    // As if the moved vertices had gone elsewhere before.
    std::vector<Vec3> earlier = soup.x1;
    for (std::size_t v = 0; v < earlier.size(); ++v)
      if (moved[v]) earlier[v] += Vec3(1.0, -2.0, 0.5 * static_cast<double>(v % 7));
    broad_phase.refit(soup.x0, earlier, margin);
    broad_phase.refit_moved(soup.x0, soup.x1, margin, moved);
  }
  std::vector<Index> numbers(static_cast<std::size_t>(surface.vertices));
  for (Index v = 0; v < surface.vertices; ++v) numbers[v] = v;
  const auto vertex = [&](Index v) { return std::span<const Index>(&numbers[v], 1); };
  const auto edge = [&](Index e) { return std::span<const Index>(surface.edges[e]); };
  const auto triangle = [&](Index t) { return std::span<const Index>(surface.triangles[t]); };
  std::vector<VertexTriangle> vertex_triangle{{-1, -1}};
  std::vector<EdgeEdge> edge_edge{{-1, -1}};
  std::vector<EdgeTriangle> edge_triangle{{-1, -1}};
  broad_phase.find_vertex_triangle(vertex_triangle, moved);
  broad_phase.find_edge_edge(edge_edge, moved);
  broad_phase.find_edge_triangle(edge_triangle, moved);
  expect_pairs(soup, margin, vertex_triangle, surface.vertices, surface.triangle_count(), vertex,
               triangle, false, moved);
  expect_pairs(soup, margin, edge_edge, surface.edge_count(), surface.edge_count(), edge, edge,
               true, moved);
  expect_pairs(soup, margin, edge_triangle, surface.edge_count(), surface.triangle_count(), edge,
               triangle, false, moved);
}

}  // namespace

TEST(BroadPhase, FindsWhatAllPairsFind) {
  check_against_all_pairs(make_soup(1, 12, 9, 30, 0.0, 0.02), 0.01);
  check_against_all_pairs(make_soup(2, 12, 9, 30, 0.2, 0.1), 0.0);
  check_against_all_pairs(make_soup(3, 5, 4, 0, 0.01, 0.0), 0.3);
}

// Trees of one group, of full and of almost empty groups, of several levels.
TEST(BroadPhase, TreesOfAllSizes) {
  for (Index nu = 2; nu < 12; ++nu)
    check_against_all_pairs(make_soup(static_cast<std::uint32_t>(nu), nu, 2, nu % 3, 0.05, 0.02),
                            0.02);
}

TEST(BroadPhase, OnlyPairsWithAMovedVertex) {
  const Soup soup = make_soup(4, 12, 9, 30, 0.1, 0.05);
  for (const Index every : {1, 7, 40, 1000}) {
    std::vector<std::uint8_t> moved(static_cast<std::size_t>(soup.surface.vertices), 0);
    for (std::size_t v = 5; v < moved.size(); v += static_cast<std::size_t>(every)) moved[v] = 1;
    check_against_all_pairs(soup, 0.01, moved);
  }
  check_against_all_pairs(
      soup, 0.01, std::vector<std::uint8_t>(static_cast<std::size_t>(soup.surface.vertices), 0));
}

// A shape at rest, whose boxes at the end are not set, may have come in between.
TEST(BroadPhase, RefitsAllAfterAShapeAtRest) {
  const Soup soup = make_soup(5, 12, 9, 0, 0.1, 0.05);
  BroadPhase broad_phase(soup.surface, soup.x0), expected(soup.surface, soup.x0);
  expected.refit(soup.x0, soup.x1, 0.01);
  broad_phase.refit(soup.x0, soup.x0, 0.01);
  broad_phase.refit_moved(soup.x0, soup.x1, 0.01, std::vector<std::uint8_t>(soup.x0.size(), 0));
  std::vector<EdgeEdge> found, wanted;
  broad_phase.find_edge_edge(found);
  expected.find_edge_edge(wanted);
  EXPECT_FALSE(wanted.empty());
  EXPECT_EQ(found, wanted);
}

TEST(BroadPhase, BoxesAreRoundedOutwards) {
  // Gaps of exactly the margin, at places that are no floats.
  std::mt19937 random(7);
  std::vector<double> places{0.1, -0.3, 1000.1, -12345.678, 1e-20, 1e9 + 0.1};
  for (int k = 0; k < 500; ++k) places.push_back(test::anywhere(random, 10.0)[0]);
  for (const double place : places) {
    Soup soup;
    soup.x0 = {Vec3(place, 0, 0), Vec3(place, 1, 0), Vec3(place, 0, 1),
               Vec3(place, 0, 0), Vec3(place, 1, 0), Vec3(place, 0, 1)};
    soup.x1 = soup.x0;
    const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
    const SurfacePart part{6, triangles, false};
    soup.surface = join_surfaces({&part, 1});
    check_against_all_pairs(soup, 0.0);
    for (int v = 3; v < 6; ++v) soup.x1[v][0] = soup.x0[v][0] = place + 0.001;
    const double gap = soup.x0[3][0] - soup.x0[0][0];
    BroadPhase broad_phase(soup.surface, soup.x0);
    broad_phase.refit(soup.x0, soup.x1, gap);
    std::vector<VertexTriangle> pairs;
    broad_phase.find_vertex_triangle(pairs);
    EXPECT_EQ(pairs.size(), 6u) << place;
  }
}

TEST(BroadPhase, FlyingTogetherAddsNoPairs) {
  Soup soup = make_soup(11, 12, 9, 0, 0.02, 0.0);
  BroadPhase broad_phase(soup.surface, soup.x0);
  std::vector<EdgeEdge> at_rest, flying;
  broad_phase.refit(soup.x0, soup.x0, 1e-3);
  broad_phase.find_edge_edge(at_rest);
  for (Vec3& x : soup.x1) x += Vec3(0.5, 0.25, -1.0);
  broad_phase.refit(soup.x0, soup.x1, 1e-3);
  broad_phase.find_edge_edge(flying);
  EXPECT_GT(at_rest.size(), 100u);
  EXPECT_EQ(flying, at_rest);
}

TEST(BroadPhase, VerticesThatAreNotFiniteMeetEverything) {
  static constexpr Index lost = 7;
  Soup soup = make_soup(5, 6, 6, 0, 0.0, 0.0);
  const auto others = std::ranges::count_if(soup.surface.triangles, [](const Triangle& t) {
    return std::ranges::find(t, lost) == t.end();
  });
  BroadPhase broad_phase(soup.surface, soup.x0);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    soup.x1[lost][1] = bad;
    broad_phase.refit(soup.x0, soup.x1, 0.0);
    std::vector<VertexTriangle> pairs;
    broad_phase.find_vertex_triangle(pairs);
    EXPECT_EQ(std::ranges::count(pairs, lost, &VertexTriangle::vertex), others) << bad;
  }
}

TEST(BroadPhase, SameListsForAnyThreadCount) {
  const Soup soup = make_soup(6, 60, 50, 300, 0.02, 0.02);
  BroadPhase broad_phase(soup.surface, soup.x0);
  const int threads = thread_count();
  std::vector<VertexTriangle> vertex_triangle[2];
  std::vector<EdgeEdge> edge_edge[2];
  std::vector<EdgeTriangle> edge_triangle[2];
  for (const int count : {1, 2, 3, 7}) {
    set_thread_count(count);
    broad_phase.refit(soup.x0, soup.x1, 0.005);
    const int to = count == 1 ? 0 : 1;
    broad_phase.find_vertex_triangle(vertex_triangle[to]);
    broad_phase.find_edge_edge(edge_edge[to]);
    broad_phase.find_edge_triangle(edge_triangle[to]);
    EXPECT_GT(edge_edge[0].size(), 1000u);
    if (count == 1) continue;
    EXPECT_EQ(vertex_triangle[0], vertex_triangle[1]);
    EXPECT_EQ(edge_edge[0], edge_edge[1]);
    EXPECT_EQ(edge_triangle[0], edge_triangle[1]);
  }
  set_thread_count(threads);
}

TEST(BroadPhase, NothingIsFoundInNothing) {
  const CollisionSurface surface;
  BroadPhase broad_phase(surface, {});
  broad_phase.refit({}, {}, 0.1);
  std::vector<VertexTriangle> pairs{{1, 2}};
  broad_phase.find_vertex_triangle(pairs);
  EXPECT_TRUE(pairs.empty());
}

TEST(CollisionSurface, JoinsPartsInOrder) {
  const std::vector<Triangle> square{{0, 1, 2}, {2, 1, 3}}, one{{2, 0, 1}};
  const SurfacePart parts[]{{4, square, false}, {3, one, true}, {4, square, false}};
  const CollisionSurface surface = join_surfaces(parts);
  EXPECT_EQ(surface.vertices, 11);
  EXPECT_EQ(surface.triangles,
            (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {6, 4, 5}, {7, 8, 9}, {9, 8, 10}}));
  EXPECT_EQ(surface.edges, (std::vector<EdgeVertices>{{0, 1},
                                                      {0, 2},
                                                      {1, 2},
                                                      {1, 3},
                                                      {2, 3},
                                                      {4, 5},
                                                      {4, 6},
                                                      {5, 6},
                                                      {7, 8},
                                                      {7, 9},
                                                      {8, 9},
                                                      {8, 10},
                                                      {9, 10}}));
  EXPECT_EQ(surface.body, (std::vector<Index>{0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2}));
  EXPECT_EQ(surface.is_solid, (std::vector<std::uint8_t>{0, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0}));
}

}  // namespace taut
