// Cloth kept from passing through cloth: whatever the end of a step was, nothing meets on the way
// to the corrected one.

#include "taut/contact/cloth_contact.h"

#include <gtest/gtest.h>

#include <random>

#include "taut/base/parallel.h"
#include "taut/contact/intersection.h"
#include "taut/mesh/grid.h"

namespace taut {
namespace {

constexpr double h = 5e-3;  // s
constexpr double thickness = 1e-3;

// Some pieces of cloth (or solids' meshes), their masses and where they are.
struct Pieces {
  std::vector<TriangleMesh> meshes;
  std::vector<CollisionBody> bodies;
  std::vector<Vec3> x0, x1;
  std::vector<double> mass, inverse_mass;
  std::vector<std::uint8_t> held;
  ContactOptions options;

  Pieces() { options.thickness = thickness; }

  // Each node moves by `motion` in the step.
  Index add(const std::string& name, const TriangleMesh& mesh, const Vec3& motion,
            bool solid = false) {
    const Index first = static_cast<Index>(x0.size());
    meshes.push_back(mesh);
    bodies.push_back({name, solid, 0.0, 0.3});
    for (const Vec3& x : mesh.positions) {
      x0.push_back(x);
      x1.push_back(x + motion);
      mass.push_back(1e-5);
      inverse_mass.push_back(solid ? 0.0 : 1e5);
      held.push_back(solid);
    }
    return first;
  }
  void hold(Index node) { held[node] = 1, inverse_mass[node] = 0.0; }

  CollisionSurface surface() const {
    std::vector<SurfacePart> parts;
    for (std::size_t k = 0; k < meshes.size(); ++k)
      parts.push_back({static_cast<Index>(meshes[k].positions.size()), meshes[k].triangles,
                       bodies[k].is_solid});
    return join_surfaces(parts);
  }

  struct Result {
    Status status;
    std::vector<Vec3> x1;
    ClothContactCounts counts;
    ZoneState zones;
  };
  Result resolve() const {
    ClothContact contact(surface(), bodies, x0, mass, options);
    Result result;
    result.x1 = x1;
    result.status = contact.resolve({x0, x0, inverse_mass, held, nullptr, 1.0, {}}, result.x1);
    result.counts = contact.counts();
    result.zones = contact.zone_state();
    return result;
  }

  // Collisions on the straight way to `end`, by the detection that the response uses, and exact
  // intersections there.
  std::size_t collisions(const std::vector<Vec3>& end) const {
    const CollisionSurface all = surface();
    PairSearch search(all, x0);
    search.near(x0, end, 1e-6, [](const CollisionPair&) { return 0.0; });
    const std::size_t on_the_way = search.colliding(x0, end, 1e-9, {}, {}).size();
    return on_the_way + find_intersections(search.broad_phase(), end).size();
  }
};

TriangleMesh sheet(Index side, double size, const Vec3& middle, const Vec3& u = Vec3::UnitX(),
                   const Vec3& v = Vec3::UnitY()) {
  return make_grid({side, side, middle - 0.5 * size * (u + v), size * u, size * v});
}

TriangleMesh triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {{a, b, c}, {{0, 1, 2}}, {}};
}

Vec3 momentum(const Pieces& p, const std::vector<Vec3>& end) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < end.size(); ++i) sum += p.mass[i] * (end[i] - p.x0[i]);
  return sum;
}

Vec3 angular_momentum(const Pieces& p, const std::vector<Vec3>& end) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < end.size(); ++i) sum += p.mass[i] * p.x0[i].cross(end[i] - p.x0[i]);
  return sum;
}

// What all parts of the motion have together: the scale of rounding and of faults.
double total_motion(const Pieces& p, const std::vector<Vec3>& end) {
  double sum = 0.0;
  for (std::size_t i = 0; i < end.size(); ++i) sum += p.mass[i] * (end[i] - p.x0[i]).norm();
  return sum;
}

// The same for angular momentum about the centre of mass.
double total_turning(const Pieces& p, const std::vector<Vec3>& end) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& x : p.x0) centre += x / p.x0.size();  // all nodes weigh the same
  double sum = 0.0;
  for (std::size_t i = 0; i < end.size(); ++i)
    sum += p.mass[i] * (p.x0[i] - centre).norm() * (end[i] - p.x0[i]).norm();
  return sum;
}

void jitter(Pieces& p, double start, double motion, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (std::size_t i = 0; i < p.x0.size(); ++i) {
    const Vec3 shift(start * u(generator), start * u(generator), start * u(generator));
    p.x0[i] += shift;
    p.x1[i] += shift + motion * Vec3(u(generator), u(generator), u(generator));
  }
}

// Ten sheets close together that all fly somewhere else: a clump, far from everything.
Pieces clump(unsigned seed, double motion) {
  Pieces p;
  for (int k = 0; k < 10; ++k) {
    const double turn = 0.3 * k;
    const Vec3 u(std::cos(turn), std::sin(turn), 0.0), v(-std::sin(turn), std::cos(turn), 0.0);
    p.add("sheet", sheet(9, 0.1, Vec3(0.5, 0, 2e-3 * k), u, v), Vec3(2e-3, 1e-3, 0));
  }
  jitter(p, 2e-4, motion, seed);
  return p;
}

TEST(ClothContact, LeavesAloneWhatDoesNotTouch) {
  Pieces p;
  p.add("a", sheet(9, 0.2, Vec3(0, 0, 0)), Vec3(0, 0, -0.01));
  p.add("b", sheet(9, 0.2, Vec3(0, 0, 0.1)), Vec3(0.01, 0, -0.02));
  const auto result = p.resolve();
  ASSERT_TRUE(result.status.ok());
  EXPECT_EQ(result.x1, p.x1) << "to the last bit";
  EXPECT_EQ(result.counts.impacts + result.counts.near + result.counts.zones, 0);
}

TEST(ClothContact, TwoSheetsThrownAtEachOtherDoNotPass) {
  for (const double way : {2e-3, 0.02, 0.5}) {
    Pieces p;
    const Index second = p.add("low", sheet(13, 0.2, Vec3(0, 0, 0)), Vec3(0, 0, way)) + 169;
    p.add("high", sheet(12, 0.2, Vec3(3e-3, 2e-3, 5e-3)), Vec3(0, 0, -way));
    jitter(p, 1e-4, 0.1 * way, 4);
    if (way > 2.5e-3) {
      EXPECT_GT(p.collisions(p.x1), 0u);
    }
    const auto result = p.resolve();
    ASSERT_TRUE(result.status.ok()) << result.status.message;
    EXPECT_EQ(p.collisions(result.x1), 0u) << way;
    EXPECT_LE((momentum(p, result.x1) - momentum(p, p.x1)).norm(), 1e-12 * total_motion(p, p.x1));
    double low = 0.0, high = 0.0;
    for (Index i = 0; i < second; ++i) low += result.x1[i].z() / second;
    for (std::size_t i = second; i < p.x0.size(); ++i)
      high += result.x1[i].z() / (p.x0.size() - second);
    if (way < 0.1) {  // else a zone turns too far
      EXPECT_EQ(result.counts.inexact, 0);
    }
    if (result.counts.inexact == 0) {
      EXPECT_LE((angular_momentum(p, result.x1) - angular_momentum(p, p.x1)).norm(),
                1e-10 * total_turning(p, p.x1));
    }
    EXPECT_LT(low, high) << "on their own sides";
    EXPECT_LT(high - low, 6e-3) << "and close together: a collision without rebound";
  }
}

TEST(ClothContact, NodeShotThroughATriangleAt100MetresASecond) {
  Pieces p;
  p.add("shield", sheet(5, 0.1, Vec3::Zero()), Vec3::Zero());
  const Index tip =
      p.add("arrow", triangle(Vec3(0.004, 0.003, 0.02), Vec3(0.01, 0, 0.05), Vec3(0, 0.01, 0.05)),
            Vec3(0, 0, -100 * h));
  EXPECT_GT(p.collisions(p.x1), 0u);
  const auto result = p.resolve();
  ASSERT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_EQ(p.collisions(result.x1), 0u);
  EXPECT_GE(result.counts.impacts, 1);
  EXPECT_LE((momentum(p, result.x1) - momentum(p, p.x1)).norm(), 1e-12 * total_motion(p, p.x1));
  // It pushes the sheet's middle before it.
  EXPECT_LT(result.x1[12].z(), -1e-3);
  EXPECT_GT(result.x1[tip].z(), result.x1[12].z() - 0.01);
}

TEST(ClothContact, EdgeOverEdge) {
  Pieces p;
  p.add("along x", triangle(Vec3(-0.05, 0, 0), Vec3(0.05, 0, 0), Vec3(0, 0.001, -0.05)),
        Vec3(0, 0, 0));
  p.add("along y",
        triangle(Vec3(0.003, -0.05, 0.004), Vec3(0.003, 0.05, 0.004), Vec3(0, 0.001, 0.05)),
        Vec3(0, 0, -0.03));
  p.options.friction = 0.0;
  EXPECT_GT(p.collisions(p.x1), 0u);
  const auto result = p.resolve();
  ASSERT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_EQ(p.collisions(result.x1), 0u);
  EXPECT_EQ(result.counts.zones, 0) << "impulses are enough";
  const double low = 0.5 * (result.x1[0].z() + result.x1[1].z()),
               high = 0.5 * (result.x1[3].z() + result.x1[4].z());
  EXPECT_GT(high, low);
  EXPECT_LT(high - low, thickness);
}

TEST(ClothContact, RepulsionPartsWhatIsTooCloseAndNoMore) {
  Pieces p;
  const Index second = p.add("low", sheet(7, 0.1, Vec3::Zero()), Vec3::Zero()) + 49;
  p.add("high", sheet(7, 0.1, Vec3(1e-3, 2e-3, 0.3 * thickness)), Vec3::Zero());
  const auto result = p.resolve();
  ASSERT_TRUE(result.status.ok());
  double gap = 0.0;
  for (Index i = 0; i < second; ++i) gap += (result.x1[second + i].z() - result.x1[i].z()) / second;
  EXPECT_NEAR(gap, (0.3 + 0.2 * 0.7) * thickness, 0.02 * thickness);
}

TEST(ClothContact, FrictionHoldsWithinItsConeAndSlowsBeyond) {
  // A sheet pressed down by p slides by s: friction takes mu p of s, or all of it.
  for (const double slide : {2e-5, 1e-3}) {
    Pieces p;
    const double press = 1e-4, mu = 0.5;
    p.options.friction = mu;
    const Index second = p.add("still", sheet(5, 0.3, Vec3::Zero()), Vec3::Zero()) + 25;
    for (Index i = 0; i < second; ++i) p.hold(i);
    p.add("sliding", sheet(5, 0.1, Vec3(0, 0, 0.999999 * thickness)), Vec3(slide, 0, -press));
    const auto result = p.resolve();
    ASSERT_TRUE(result.status.ok());
    double slid = 0.0;
    for (Index i = second; i < second + 25; ++i) slid += (result.x1[i].x() - p.x0[i].x()) / 25;
    EXPECT_NEAR(slid, std::max(0.0, slide - mu * press), 2e-6) << slide;
  }
}

TEST(ClothContact, ClumpKeepsItsMomentum) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    Pieces p = clump(seed, 4e-3);
    ASSERT_EQ(p.collisions(p.x0), 0u);
    const auto result = p.resolve();
    ASSERT_TRUE(result.status.ok()) << result.status.message;
    EXPECT_GT(result.counts.impacts, 100);
    EXPECT_EQ(p.collisions(result.x1), 0u);
    EXPECT_LE((momentum(p, result.x1) - momentum(p, p.x1)).norm(), 1e-12 * total_motion(p, p.x1));
    EXPECT_LE((angular_momentum(p, result.x1) - angular_momentum(p, p.x1)).norm(),
              1e-10 * total_turning(p, p.x1));
  }
}

TEST(ClothContact, ZonesKeepAngularMomentumToo) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    Pieces p = clump(seed, 2e-3);
    p.options.sweeps = 0;
    p.options.friction = 0.0;
    const auto result = p.resolve();
    ASSERT_TRUE(result.status.ok()) << result.status.message;
    EXPECT_GT(result.counts.zone_nodes, 50);
    EXPECT_EQ(result.counts.inexact, 0);
    EXPECT_EQ(p.collisions(result.x1), 0u);
    const double scale = total_motion(p, p.x1);
    EXPECT_LE((momentum(p, result.x1) - momentum(p, p.x1)).norm(), 1e-10 * scale);
    EXPECT_LE((angular_momentum(p, result.x1) - angular_momentum(p, p.x1)).norm(),
              1e-10 * scale * 0.5);
    EXPECT_EQ(static_cast<Index>(result.zones.node.size()), result.counts.zone_nodes);
    EXPECT_TRUE(std::ranges::is_sorted(result.zones.node));
  }
}

TEST(ClothContact, PinnedNodesAreNotMoved) {
  Pieces p;
  const Index second = p.add("held", sheet(9, 0.2, Vec3::Zero()), Vec3(0, 0, 0.01)) + 81;
  for (Index i = 0; i < second; ++i) p.hold(i);
  p.add("free", sheet(6, 0.1, Vec3(1e-3, 0, 4e-3)), Vec3::Zero());
  const auto result = p.resolve();
  ASSERT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_EQ(p.collisions(result.x1), 0u);
  for (Index i = 0; i < second; ++i) EXPECT_EQ(result.x1[i], p.x1[i]);
  for (std::size_t i = second; i < p.x0.size(); ++i)
    EXPECT_GT(result.x1[i].z(), 0.01) << "carried up";
}

TEST(ClothContact, PinsThatCrossEachOtherAreNamed) {
  Pieces p;
  const Index second = p.add("left", sheet(4, 0.1, Vec3::Zero()), Vec3(0, 0, 0.01)) + 16;
  p.add("right", sheet(4, 0.1, Vec3(3e-3, 0, 5e-3)), Vec3(0, 0, -0.01));
  for (Index i = 0; i < 2 * second; ++i) p.hold(i);
  const auto result = p.resolve();
  EXPECT_FALSE(result.status.ok());
  EXPECT_NE(result.status.message.find("cloth 'left' node"), std::string::npos)
      << result.status.message;
  EXPECT_NE(result.status.message.find("cloth 'right' node"), std::string::npos)
      << result.status.message;
}

TEST(ClothContact, PinchedBetweenTwoSolidsIsNamed) {
  Pieces p;
  p.add("cloth", sheet(7, 0.1, Vec3::Zero()), Vec3::Zero());
  p.add("press", sheet(4, 0.3, Vec3(2e-3, 0, 4e-3)), Vec3(0, 0, -5e-3), true);
  p.add("anvil", sheet(4, 0.3, Vec3(1e-3, 0, -4e-3)), Vec3(0, 0, 5e-3), true);
  const auto result = p.resolve();
  EXPECT_FALSE(result.status.ok());
  for (const char* name : {"cloth 'cloth'", "solid 'press'", "solid 'anvil'"})
    EXPECT_NE(result.status.message.find(name), std::string::npos) << result.status.message;
}

TEST(ClothContact, SameBitsForAnyNumberOfThreads) {
  const int usual = thread_count();
  const Pieces p = clump(9, 6e-3);
  set_thread_count(1);
  const auto one = p.resolve();
  set_thread_count(4);
  const auto four = p.resolve();
  set_thread_count(usual);
  ASSERT_TRUE(one.status.ok());
  EXPECT_EQ(one.x1, four.x1);
  EXPECT_EQ(one.zones, four.zones);
  EXPECT_EQ(one.counts.impacts, four.counts.impacts);
}

// However wild the motion: it is resolved or refused, never wrong.
TEST(ClothContact, WildMotionIsResolvedOrRefused) {
  int resolved = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Pieces p = clump(seed, seed % 2 ? 0.01 : 0.02);
    const auto result = p.resolve();
    if (!result.status.ok()) continue;
    ++resolved;
    EXPECT_EQ(p.collisions(result.x1), 0u) << seed;
  }
  EXPECT_GE(resolved, 4);
}

}  // namespace
}  // namespace taut
