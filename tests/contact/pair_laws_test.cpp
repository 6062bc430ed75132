// Which thickness and friction two bodies have: the pair's own, else the solid's, else the scene's.

#include "taut/contact/pair_laws.h"

#include <gtest/gtest.h>

namespace taut {
namespace {

const std::vector<CollisionBody> bodies{
    {"shirt"}, {"sheet"}, {"body", true, 0.0, 0.5}, {"chair", true, 5e-3, 0.6}};

ContactOptions with(std::vector<ContactPair> pairs) {
  ContactOptions options;
  options.thickness = 1e-3, options.friction = 0.3;
  options.pairs = std::move(pairs);
  return options;
}

void expect_law(const PairLaws& laws, Index a, Index b, double thickness, double friction) {
  for (const PairLaw& law : {laws.of(a, b), laws.of(b, a)}) {
    EXPECT_EQ(law.thickness, thickness) << bodies[a].name << " and " << bodies[b].name;
    EXPECT_EQ(law.friction, friction) << bodies[a].name << " and " << bodies[b].name;
  }
}

TEST(PairLaws, WithoutPairsAClothHasTheScenesAndASolidItsOwn) {
  const PairLaws laws(with({}), bodies);
  expect_law(laws, 0, 0, 1e-3, 0.3);
  expect_law(laws, 0, 1, 1e-3, 0.3);
  expect_law(laws, 1, 2, 1e-3, 0.5);
  expect_law(laws, 1, 3, 5e-3, 0.6);
  EXPECT_EQ(laws.smallest_thickness(), 1e-3);
  EXPECT_EQ(laws.largest_thickness(), 5e-3);
}

TEST(PairLaws, APairGoesFirstAndSaysOnlyWhatItSays) {
  const PairLaws laws(with({{"shirt", "shirt", 4e-4, -1.0},
                            {"sheet", "shirt", -1.0, 0.0},
                            {"shirt", "chair", 8e-3, 0.9}}),
                      bodies);
  expect_law(laws, 0, 0, 4e-4, 0.3);
  expect_law(laws, 0, 1, 1e-3, 0.0);
  expect_law(laws, 1, 1, 1e-3, 0.3);
  expect_law(laws, 0, 3, 8e-3, 0.9);
  expect_law(laws, 1, 3, 5e-3, 0.6);
  EXPECT_EQ(laws.smallest_thickness(), 4e-4);
  EXPECT_EQ(laws.largest_thickness(), 8e-3);
}

}  // namespace
}  // namespace taut
