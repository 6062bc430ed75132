// Cloth that intersects at the start is drawn apart, keeps its shape, and CGAL finds nothing left;
// what cannot be repaired is left as it was.

#include "taut/contact/untangle.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "contact/independent_judge.h"
#include "taut/base/parallel.h"
#include "taut/mesh/grid.h"

namespace taut {
namespace {

constexpr double thickness = 1e-3;

// Pieces of cloth (or solids' meshes) with their shape at rest, and where they are.
struct Wardrobe {
  std::vector<TriangleMesh> meshes;
  std::vector<CollisionBody> bodies;
  std::vector<Vec3> x;
  std::vector<std::uint8_t> held;
  std::vector<Solid> solids;

  // At rest as in `mesh`; there it is at `place` of that.
  template <class Place>
  void add(const std::string& name, const TriangleMesh& mesh, const Place& place,
           bool solid = false) {
    meshes.push_back(mesh);
    bodies.push_back({name, solid, 0.0, 0.3});
    for (const Vec3& rest : mesh.positions) x.push_back(place(rest));
    held.resize(x.size(), solid);
  }
  void jitter(double size, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> u(-size, size);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (const Vec3 shift(u(generator), u(generator), u(generator)); !held[i]) x[i] += shift;
  }

  CollisionSurface surface() const {
    std::vector<SurfacePart> parts;
    for (std::size_t k = 0; k < meshes.size(); ++k)
      parts.push_back({static_cast<Index>(meshes[k].positions.size()), meshes[k].triangles,
                       bodies[k].is_solid});
    return join_surfaces(parts);
  }
  std::vector<double> rest_lengths() const {
    std::vector<Vec3> rest;
    for (const TriangleMesh& mesh : meshes)
      rest.insert(rest.end(), mesh.positions.begin(), mesh.positions.end());
    std::vector<double> lengths;
    for (const EdgeVertices& edge : surface().edges)
      lengths.push_back((rest[edge[1]] - rest[edge[0]]).norm());
    return lengths;
  }
  std::size_t judged() const {
    const CollisionSurface all = surface();
    return test::intersecting_triangles(x, all.triangles, all.is_solid).size();
  }
  // How far edges' lengths are outside the range between what they were and what they are at rest,
  // at most, as a share.
  double length_change(const std::vector<Vec3>& start) const {
    const CollisionSurface all = surface();
    const std::vector<double> rest = rest_lengths();
    double worst = 0.0;
    for (std::size_t e = 0; e < all.edges.size(); ++e) {
      const auto [a, b] = all.edges[e];
      if (all.is_solid[a]) continue;
      const double before = (start[b] - start[a]).norm(), now = (x[b] - x[a]).norm();
      worst = std::max(
          {worst, now / std::max(before, rest[e]) - 1, 1 - now / std::min(before, rest[e])});
    }
    return worst;
  }
  UntangleReport untangle() {
    const CollisionSurface all = surface();
    const std::vector<double> rest = rest_lengths(), mass(x.size(), 1e-5);
    ContactOptions contact;
    contact.thickness = thickness;
    return taut::untangle({all, bodies, mass, held, rest, solids, contact}, x);
  }
};

TriangleMesh sheet(Index nu, Index nv, double width, double height) {
  return make_grid(
      {nu, nv, Vec3(-0.5 * width, -0.5 * height, 0), Vec3(width, 0, 0), Vec3(0, height, 0)});
}
Vec3 as_it_is(const Vec3& x) { return x; }

// A dent that pokes through the sheet below, or a border that has slipped under it.
Wardrobe dented() {
  Wardrobe w;
  w.add("low", sheet(25, 25, 0.24, 0.24), as_it_is);
  w.add("high", sheet(23, 23, 0.22, 0.22), [](const Vec3& p) {
    return Vec3(p.x() + 3e-3, p.y() + 2e-3,
                3e-3 - 8e-3 * std::exp(-p.squaredNorm() / (2 * 0.03 * 0.03)));
  });
  return w;
}

Wardrobe slipped_under() {
  Wardrobe w;
  w.add("low", sheet(25, 25, 0.24, 0.24), as_it_is);
  w.add("high", sheet(23, 23, 0.22, 0.22), [](const Vec3& p) {
    const double a = 0.1;
    return Vec3(p.x() * std::cos(a) + 2e-3, p.y() + 1e-3, 8e-3 - p.x() * std::sin(a));
  });
  return w;
}

// Bent back over itself, with a dent in the upper layer that goes through the lower one.
Wardrobe folded() {
  constexpr double radius = 4e-3;
  Wardrobe w;
  w.add("fold", sheet(41, 21, 0.2, 0.1), [](const Vec3& p) {
    const double arc = radius * std::numbers::pi;
    if (p.x() < 0) return Vec3(p.x(), p.y(), 0);
    if (p.x() < arc)
      return Vec3(radius * std::sin(p.x() / radius), p.y(),
                  radius * (1 - std::cos(p.x() / radius)));
    const double x = arc - p.x(), distance2 = std::pow(x + 0.04, 2) + p.y() * p.y();
    return Vec3(x, p.y(), 2 * radius - 11e-3 * std::exp(-distance2 / (2 * 0.015 * 0.015)));
  });
  return w;
}

Wardrobe poked() {
  Wardrobe w;
  w.add("flat", sheet(25, 25, 0.24, 0.24), as_it_is);
  w.add("corner", sheet(17, 17, 0.16, 0.16), [](const Vec3& p) {
    const Vec3 along = Vec3(0.6, 0, 0.8), across = Vec3(-0.64, 0.6, 0.48);
    return Vec3(Vec3(0.011, 0.007, -0.012) + (p.x() + 0.08) * along + (p.y() + 0.08) * across);
  });
  return w;
}

Wardrobe shaken(Wardrobe w, unsigned seed) {
  w.jitter(2e-4, seed);
  return w;
}

struct Case {
  const char* name;
  Wardrobe (*make)();
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Tangle : public testing::TestWithParam<Case> {};

TEST_P(Tangle, IsDrawnApartAndKeepsItsShape) {
  if (!test::judge_available()) GTEST_SKIP() << test::no_judge;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Wardrobe w = shaken(GetParam().make(), seed);
    const std::vector<Vec3> start = w.x;
    ASSERT_GT(w.judged(), 0u);
    const UntangleReport report = w.untangle();
    EXPECT_TRUE(report.status.ok()) << seed << ": " << report.status.message;
    if (!report.status.ok()) continue;
    EXPECT_EQ(w.judged(), 0u) << seed;
    Index moved = 0;
    double largest = 0.0;
    for (std::size_t i = 0; i < start.size(); ++i) {
      moved += w.x[i] != start[i];
      largest = std::max(largest, (w.x[i] - start[i]).norm());
    }
    EXPECT_EQ(report.moved, moved);
    EXPECT_EQ(report.largest, largest);
    EXPECT_LT(report.moved, static_cast<Index>(start.size()) / 3)
        << "it leaves alone what does not take part";
    EXPECT_LE(w.length_change(start), 0.03) << seed;
    EXPECT_GE(report.gap, 0.05 * thickness) << seed;
  }
}

const Case cases[] = {
    {"dented", dented}, {"slipped_under", slipped_under}, {"folded", folded}, {"poked", poked}};
INSTANTIATE_TEST_SUITE_P(All, Tangle, testing::ValuesIn(cases),
                         [](const auto& c) { return std::string(c.param.name); });

// A strip through the middle of a sheet, far out on both sides, held at its ends.
TEST(Untangle, SaysWhatItCannotDoAndChangesNothing) {
  Wardrobe w;
  w.add("sheet", sheet(21, 21, 0.2, 0.2), as_it_is);
  w.add("strip", sheet(31, 4, 0.6, 0.03),
        [](const Vec3& p) { return Vec3(p.y() + 1e-3, 2e-3, p.x() + 1e-3); });
  for (const Index end : {0, 30}) w.held[441 + end] = 1;
  const std::vector<Vec3> start = w.x;
  const UntangleReport report = w.untangle();
  EXPECT_FALSE(report.status.ok());
  EXPECT_NE(report.status.message.find("are left after"), std::string::npos)
      << report.status.message;
  EXPECT_FALSE(report.left.empty());
  EXPECT_EQ(w.x, start);
  EXPECT_EQ(report.moved, 0);
}

TEST(Untangle, LeavesAloneWhatIsFine) {
  Wardrobe w;
  w.add("low", sheet(9, 9, 0.1, 0.1), as_it_is);
  w.add("high", sheet(9, 9, 0.1, 0.1), [](const Vec3& p) { return Vec3(p.x(), p.y(), 1e-4); });
  const std::vector<Vec3> start = w.x;
  const UntangleReport report = w.untangle();
  EXPECT_TRUE(report.status.ok());
  EXPECT_EQ(report.intersections_before, 0);
  EXPECT_EQ(report.moved, 0);
  EXPECT_EQ(w.x, start);
}

TEST(Untangle, HeldNodesStayAndOthersGiveWay) {
  Wardrobe w = shaken(poked(), 3);
  for (Index i = 0; i < 625; ++i) w.held[i] = 1;
  const std::vector<Vec3> start = w.x;
  const UntangleReport report = w.untangle();
  ASSERT_TRUE(report.status.ok()) << report.status.message;
  for (Index i = 0; i < 625; ++i) ASSERT_EQ(w.x[i], start[i]);
  EXPECT_EQ(w.judged(), 0u);
}

TEST(Untangle, ComesOutOfSolids) {
  Wardrobe w;
  w.add("sheet", sheet(21, 21, 0.2, 0.2), as_it_is);
  Solid ball;
  ball.radius = 0.05;
  ball.thickness = 1e-3;
  ball.initial.translation = Vec3(0.003, 0.002, -0.045);
  w.solids.push_back(ball);
  w.add(
      "block", sheet(5, 5, 0.02, 0.02),
      [](const Vec3& p) {
        return Vec3(p.x() + 0.07, p.y() + 0.07 - 0.3 * p.x(), 2e-3 + 0.4 * p.x());
      },
      true);
  w.jitter(2e-4, 1);
  ASSERT_GT(w.judged(), 0u);
  const UntangleReport report = w.untangle();
  ASSERT_TRUE(report.status.ok()) << report.status.message;
  EXPECT_GT(report.inside_solids_before, 10);
  EXPECT_EQ(report.inside_solids_after, 0);
  EXPECT_EQ(w.judged(), 0u);
  for (Index i = 0; i < 441; ++i)
    EXPECT_GT((w.x[i] - ball.initial.translation).norm(), ball.radius + ball.thickness - 2e-5) << i;
}

// Half a ball below a sheet whose border is held: the way over it is longer than the sheet.
TEST(Untangle, SaysWhatItWouldHaveToStretch) {
  Wardrobe w;
  w.add("sheet", sheet(21, 21, 0.2, 0.2), [](const Vec3& p) { return Vec3(p.x(), p.y(), 1e-3); });
  for (std::size_t i = 0; i < w.x.size(); ++i)
    w.held[i] = w.x[i].head<2>().cwiseAbs().maxCoeff() > 0.099;
  Solid ball;
  ball.radius = 0.08;
  w.solids.push_back(ball);
  const std::vector<Vec3> start = w.x;
  const UntangleReport report = w.untangle();
  EXPECT_FALSE(report.status.ok());
  EXPECT_EQ(report.intersections_before, 0);
  const std::string said = fmt::format("0 intersections, with {} nodes inside solids, can only be",
                                       report.inside_solids_before);
  EXPECT_TRUE(report.status.message.starts_with(said)) << report.status.message;
  EXPECT_EQ(w.x, start);
}

TEST(Untangle, SameBitsForAnyNumberOfThreads) {
  const int usual = thread_count();
  std::vector<Vec3> first;
  for (const int threads : {1, 4}) {
    set_thread_count(threads);
    Wardrobe w = shaken(folded(), 5);
    ASSERT_TRUE(w.untangle().status.ok());
    if (first.empty()) {
      first = w.x;
    } else {
      EXPECT_EQ(w.x, first);
    }
  }
  set_thread_count(usual);
}

}  // namespace
}  // namespace taut
