#include "taut/contact/pair_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "taut/base/parallel.h"
#include "triangle_soups.h"

namespace taut {

namespace {

using test::Soup;
using Found = std::set<std::pair<bool, std::array<Index, 4>>>;

constexpr double kept_apart = 2e-4, reach = 0.02;

// All pairs without a common vertex, one by one.
Found colliding_by_trial(const Soup& soup) {
  Found found;
  const auto attempt = [&](const CollisionPair& pair) {
    std::set<Index> nodes(pair.node.begin(), pair.node.end());
    if (nodes.size() < 4 ||
        (soup.surface.is_solid[pair.node[0]] && soup.surface.is_solid[pair.node[3]]))
      return;
    const double start = closest(pair, soup.x0).distance;
    CcdOptions options;
    options.minimum_separation = std::min(kept_apart, PairSearch::kept_share * start);
    if (start > 0.0 && impact(pair, soup.x0, soup.x1, options).hit)
      found.emplace(pair.edges, pair.node);
  };
  for (Index t = 0; t < soup.surface.triangle_count(); ++t)
    for (Index v = 0; v < soup.surface.vertices; ++v)
      attempt(pair_of(soup.surface, VertexTriangle{v, t}));
  for (Index e = 0; e < soup.surface.edge_count(); ++e)
    for (Index f = e + 1; f < soup.surface.edge_count(); ++f)
      attempt(pair_of(soup.surface, EdgeEdge{e, f}));
  return found;
}

Found as_set(const std::vector<CollidingPair>& pairs) {
  Found found;
  for (const CollidingPair& hit : pairs)
    EXPECT_TRUE(found.emplace(hit.pair.edges, hit.pair.node).second) << "a pair is reported twice";
  return found;
}

}  // namespace

// One search serves a step: the ends change a little, or a lot at some nodes, again and again, and
// nothing gets lost.
TEST(PairSearch, FollowsTheEndsOfTheWay) {
  std::mt19937 random(5);
  Soup soup = test::make_soup(8, 9, 9, 12, 0.0, 0.03);
  PairSearch search(soup.surface, soup.x0);
  search.near(soup.x0, soup.x1, reach, [](const CollisionPair&) { return 0.0; });
  std::size_t most = 0;
  for (int change = 0; change < 12; ++change) {
    // Small changes add up; every third time some nodes go far.
    for (std::size_t v = 0; v < soup.x1.size(); ++v) {
      soup.x1[v] += test::anywhere(random, 0.2 * reach);
      if (change % 3 == 2 && v % 5 == 0) soup.x1[v] += test::anywhere(random, 0.1);
    }
    const Found found = as_set(search.colliding(soup.x0, soup.x1, kept_apart, {}, {}));
    EXPECT_EQ(found, colliding_by_trial(soup)) << change;
    most = std::max(most, found.size());
  }
  EXPECT_GT(most, 20u);
}

TEST(PairSearch, OnlyPairsWithAMovedNodeAreTestedAgain) {
  Soup soup = test::make_soup(9, 9, 9, 12, 0.0, 0.05);
  PairSearch search(soup.surface, soup.x0);
  search.near(soup.x0, soup.x1, reach, [](const CollisionPair&) { return 0.0; });
  const Found all = as_set(search.colliding(soup.x0, soup.x1, kept_apart, {}, {}));
  std::vector<std::uint8_t> moved(soup.x0.size(), 0);
  for (std::size_t v = 3; v < moved.size(); v += 7) moved[v] = 1;
  Found with_moved;
  for (const auto& pair : all)
    if (std::ranges::any_of(pair.second, [&](Index v) { return moved[v] != 0; }))
      with_moved.insert(pair);
  EXPECT_FALSE(with_moved.empty());
  EXPECT_LT(with_moved.size(), all.size());
  EXPECT_EQ(as_set(search.colliding(soup.x0, soup.x1, kept_apart, moved, {})), with_moved);
}

}  // namespace taut
