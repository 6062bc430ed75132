// contact.pair: two cloths on one slope, and cloth on cloth, with friction and thickness of their
// own; and what is refused.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "taut/base/error.h"
#include "taut/scene/scene_file.h"
#include "taut/scene/scene_simulation.h"
#include "taut/sim/cloth_model.h"
#include "taut/step/state.h"

namespace taut {
namespace {

constexpr double g = 9.81, slope = 0.35;  // tangent

// Gravity leans instead of the ground. A small stiff sheet at a height, another one beside it.
std::string two_sheets(double height, const std::string& rest) {
  const double down = g / std::sqrt(1 + slope * slope);
  return fmt::format(R"(
gravity = [{}, 0, {}]
time = {{ step = 2e-3, frames = 150 }}
[[cloth]]
name = "left"
grid = {{ nodes = [5, 5], origin = [0, 0, {}], u = [0.1, 0, 0], v = [0, 0.1, 0] }}
density = 0.2
k_stretch = 500
[[cloth]]
name = "right"
grid = {{ nodes = [5, 5], origin = [0, 0.3, {}], u = [0.1, 0, 0], v = [0, 0.1, 0] }}
density = 0.2
k_stretch = 500
{})",
                     slope * down, -down, height, height, rest);
}

struct Means {
  Vec3 left = Vec3::Zero(), right = Vec3::Zero();
};

Means run(const std::string& toml, int steps) {
  SceneSimulation simulation(read_scene_text(toml, "pair.toml"));
  StepReport record;
  const auto means = [&] {
    Means m;
    for (const ClothPart& part : simulation.cloth().parts()) {
      Vec3 sum = Vec3::Zero();
      for (Index i = 0; i < part.node_count; ++i) sum += simulation.state().x[part.first_node + i];
      if (part.name == "left") m.left = sum / part.node_count;
      if (part.name == "right") m.right = sum / part.node_count;
    }
    return m;
  };
  const Means start = means();
  for (int k = 0; k < steps; ++k) {
    const Status status = simulation.step(record);
    EXPECT_TRUE(status.ok()) << status.message;
    if (!status.ok()) break;
  }
  const Means end = means();
  return {end.left - start.left, end.right - start.right};
}

double slid(double mu, double t) {
  return 0.5 * g * (slope - mu) / std::sqrt(1 + slope * slope) * t * t;
}

TEST(ContactPair, TwoClothsOnOneSlopeSlideEachWithItsOwnFriction) {
  const std::string ground = R"(
[[solid]]
name = "ground"
shape = "plane"
friction = 0.6
)";
  const Means without = run(two_sheets(0.0, ground), 150);
  EXPECT_NEAR(without.left.x(), 0.0, 1e-4);
  EXPECT_NEAR(without.right.x(), 0.0, 1e-4);
  const Means with = run(
      two_sheets(
          0.0, ground + "[[contact.pair]]\ncloth = \"right\"\nwith = \"ground\"\nfriction = 0.1\n"),
      150);
  EXPECT_NEAR(with.left.x(), 0.0, 1e-4);
  EXPECT_NEAR(with.right.x(), slid(0.1, 0.3), 0.03 * slid(0.1, 0.3));
}

TEST(ContactPair, EachClothKeepsItsOwnDistanceFromASolid) {
  const std::string ground = R"(
[[solid]]
name = "ground"
shape = "plane"
friction = 1
thickness = 1e-3
[[contact.pair]]
cloth = "left"
with = "ground"
thickness = 5e-3
)";
  const double height = 0.02;
  const Means moved = run(two_sheets(height, ground), 150);
  EXPECT_NEAR(height + moved.left.z(), 5e-3, 1e-4);
  EXPECT_NEAR(height + moved.right.z(), 1e-3, 1e-4);
}

// Both lie on a wide sheet that is held; only one of them slides on it.
TEST(ContactPair, ClothSlidesOnClothWithThePairsFriction) {
  const std::string table = R"(
[contact]
thickness = 2e-3
friction = 0.6
[[contact.pair]]
cloth = "table"
with = "right"
friction = 0.1
[[cloth]]
name = "table"
grid = { nodes = [9, 9], origin = [-0.2, -0.1, 0], u = [1, 0, 0], v = [0, 0.6, 0] }
density = 0.2
pin = [{ nodes = [)";
  std::string nodes = "0";
  for (int k = 1; k < 81; ++k) nodes += fmt::format(", {}", k);
  const Means moved = run(two_sheets(2e-3, table + nodes + "] }]\n"), 100);
  EXPECT_NEAR(moved.left.x(), 0.0, 2e-3);
  EXPECT_NEAR(moved.right.x(), slid(0.1, 0.2), 0.1 * slid(0.1, 0.2));
}

TEST(ContactPair, NamesThatAreNotThereAndPairsThatSayNothingAreRefused) {
  const auto message = [](const std::string& pair) -> std::string {
    try {
      read_scene_text(two_sheets(0.1, pair), "pair.toml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(message("[[contact.pair]]\ncloth = \"lefd\"\nwith = \"right\"\nfriction = 0.1\n")
                .find("no cloth named 'lefd'"),
            std::string::npos);
  EXPECT_NE(message("[[contact.pair]]\ncloth = \"left\"\nwith = \"floor\"\nfriction = 0.1\n")
                .find("no cloth or solid named 'floor'"),
            std::string::npos);
  EXPECT_NE(message("[[contact.pair]]\ncloth = \"left\"\nwith = \"right\"\n")
                .find("give a thickness, a friction or both"),
            std::string::npos);
  EXPECT_NE(message("[[contact.pair]]\ncloth = \"left\"\nwith = \"right\"\nthickness = 0\n")
                .find("above 0"),
            std::string::npos);
  const std::string one = "[[contact.pair]]\ncloth = \"left\"\nwith = \"right\"\nfriction = 0.1\n";
  const std::string turned =
      "[[contact.pair]]\ncloth = \"right\"\nwith = \"left\"\nfriction = 0.2\n";
  EXPECT_NE(message(one + turned).find("keep one of them"), std::string::npos);
}

TEST(ContactPair, IsWrittenAndReadBack) {
  Scene scene = read_scene_text(
      two_sheets(0.1, "[[contact.pair]]\ncloth = \"left\"\nwith = \"right\"\nfriction = 0.1\n"),
      "pair.toml");
  ASSERT_EQ(scene.contact.pairs.size(), 1u);
  const Scene again = read_scene_text(scene_to_toml(scene), "again.toml");
  EXPECT_EQ(again.contact.pairs, scene.contact.pairs);
}

}  // namespace
}  // namespace taut
