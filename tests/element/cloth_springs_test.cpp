// Which nodes are joined: Provot's neighbourhood on grids, edges and hinges on meshes.

#include "taut/element/cloth_springs.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <set>

#include "taut/base/error.h"

namespace taut {
namespace {

using Models = std::vector<std::unique_ptr<SpringModel>>;
using Pair = std::pair<Index, Index>;

std::map<ForceClass, std::set<Pair>> pairs_of(const Models& models) {
  std::map<ForceClass, std::set<Pair>> pairs;
  for (const auto& model : models)
    for (const Spring& s : model->springs()) {
      const bool fresh = pairs[model->force_class()].insert(std::minmax(s.i, s.j)).second;
      EXPECT_TRUE(fresh) << "spring " << s.i << "-" << s.j << " twice";
    }
  return pairs;
}

// A class's neighbours of node (i, j), by definition.
std::set<Index> neighbours(const GridShape& g, ForceClass force_class, Index i, Index j) {
  std::set<Index> found;
  for (Index dj = -2; dj <= 2; ++dj)
    for (Index di = -2; di <= 2; ++di) {
      const Index squared = di * di + dj * dj;
      const Index wanted = force_class == ForceClass::stretch ? 1
                           : force_class == ForceClass::shear ? 2
                                                              : 4;
      const bool inside = i + di >= 0 && i + di < g.nu && j + dj >= 0 && j + dj < g.nv;
      if (inside && squared == wanted) found.insert(g.node(i + di, j + dj));
    }
  return found;
}

TEST(GridSprings, EveryNodeHasProvotsNeighbours) {
  const std::vector<Pair> sizes{{2, 2}, {2, 3}, {3, 2}, {3, 3}, {2, 9}, {9, 2}, {4, 7}, {12, 5}};
  for (const auto& [nu, nv] : sizes) {
    const GridShape g{.nu = nu, .nv = nv};
    const TriangleMesh mesh = make_grid(g);
    auto pairs = pairs_of(grid_springs(g, mesh.positions, {}, 0, "sheet"));
    EXPECT_EQ(pairs[ForceClass::stretch].size(),
              static_cast<std::size_t>((nu - 1) * nv + nu * (nv - 1)));
    EXPECT_EQ(pairs[ForceClass::shear].size(), static_cast<std::size_t>(2 * (nu - 1) * (nv - 1)));
    EXPECT_EQ(pairs[ForceClass::bend].size(),
              static_cast<std::size_t>(std::max(0, nu - 2) * nv + nu * std::max(0, nv - 2)));
    for (const ForceClass force_class : {ForceClass::stretch, ForceClass::shear, ForceClass::bend})
      for (Index j = 0; j < nv; ++j)
        for (Index i = 0; i < nu; ++i) {
          std::set<Index> joined;
          for (const auto& [a, b] : pairs[force_class]) {
            if (a == g.node(i, j)) joined.insert(b);
            if (b == g.node(i, j)) joined.insert(a);
          }
          EXPECT_EQ(joined, neighbours(g, force_class, i, j))
              << name_of(force_class) << " of (" << i << ", " << j << ") on " << nu << "x" << nv;
          const bool interior = i >= 2 && j >= 2 && i + 2 < nu && j + 2 < nv;
          EXPECT_TRUE(!interior || joined.size() == 4u);
        }
  }
}

TEST(GridSprings, RestLengthsAreDistancesInAnyOrientation) {
  const Eigen::Quaterniond turn(0.3, -0.5, 0.7, 0.2);
  const Mat3 rotation = turn.normalized().toRotationMatrix();
  const double a = 0.6, b = 1.4;
  const GridShape g{.nu = 7,
                    .nv = 8,
                    .origin = Vec3(3, -2, 5),
                    .u = rotation * Vec3(a, 0, 0),
                    .v = rotation * Vec3(0, b, 0)};
  const double du = a / 6, dv = b / 7;
  const TriangleMesh mesh = make_grid(g);
  for (const auto& model : grid_springs(g, mesh.positions, {}, 0, "sheet"))
    for (const Spring& s : model->springs()) {
      const Index di = std::abs(s.i % 7 - s.j % 7), dj = std::abs(s.i / 7 - s.j / 7);
      EXPECT_NEAR(s.parameters.rest_length, std::hypot(di * du, dj * dv), 1e-14);
    }
}

TEST(GridSprings, MaterialGoesToItsClass) {
  SpringMaterial m{.k_stretch = 1,
                   .k_shear = 2,
                   .k_bend = 3,
                   .k_damp_stretch = 4,
                   .k_damp_shear = 5,
                   .k_damp_bend = 6};
  const GridShape g{.nu = 4, .nv = 4};
  const TriangleMesh mesh = make_grid(g);
  const auto expect = [&](std::array<SpringLawKind, 3> laws, double cap) {
    const Models models = grid_springs(g, mesh.positions, m, 100, "sheet");
    ASSERT_EQ(models.size(), 3u);
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(models[c]->force_class(), static_cast<ForceClass>(c));
      EXPECT_EQ(models[c]->law(), laws[c]);
      for (const Spring& s : models[c]->springs()) {
        EXPECT_EQ(s.parameters.stiffness, 1.0 + c);
        EXPECT_EQ(s.parameters.damping, 4.0 + c);
        EXPECT_EQ(s.parameters.cap, c == 2 ? cap : 0.0);
        EXPECT_TRUE(s.i >= 100 && s.i < 116 && s.j >= 100 && s.j < 116) << "shifted by first_node";
      }
    }
  };
  expect({SpringLawKind::buckling, SpringLawKind::buckling, SpringLawKind::linear}, 1.0);
  m.compression = Compression::linear;
  m.bend_model = BendModel::choi_ko;
  expect({SpringLawKind::linear, SpringLawKind::linear, SpringLawKind::choi_ko}, 1.0);
  m.bend_cap = 77.0;
  expect({SpringLawKind::linear, SpringLawKind::linear, SpringLawKind::choi_ko}, 77.0);
}

TEST(MeshSprings, TetrahedronsSurfaceHasSixEdgesAndSixHinges) {
  TriangleMesh mesh;
  mesh.positions = {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  auto pairs = pairs_of(mesh_springs(mesh, {}, 0, "tetrahedron"));
  EXPECT_EQ(pairs[ForceClass::stretch].size(), 6u);
  EXPECT_EQ(pairs[ForceClass::bend].size(), 6u) << "across each edge lies the opposite one";
  EXPECT_EQ(pairs.count(ForceClass::shear), 0u);
}

TEST(MeshSprings, FanOfTrianglesBendsAcrossItsSpokes) {
  // A hexagon about node 0: 12 edges, 6 of them inside; bend springs join nodes two apart on the
  // rim.
  TriangleMesh mesh;
  mesh.positions = {Vec3::Zero()};
  for (int k = 0; k < 6; ++k)
    mesh.positions.push_back(Vec3(std::cos(k * std::acos(0.5)), std::sin(k * std::acos(0.5)), 0));
  for (Index k = 0; k < 6; ++k) mesh.triangles.push_back({0, 1 + k, 1 + (k + 1) % 6});
  const Models models = mesh_springs(mesh, {}, 10, "hexagon");
  auto pairs = pairs_of(models);
  EXPECT_EQ(pairs[ForceClass::stretch].size(), 12u);
  std::set<Pair> rim;
  for (Index k = 0; k < 6; ++k) rim.insert(std::minmax(11 + k, 11 + (k + 2) % 6));
  EXPECT_EQ(pairs[ForceClass::bend], rim);
  for (const auto& model : models)
    for (const Spring& s : model->springs())
      EXPECT_NEAR(s.parameters.rest_length,
                  model->force_class() == ForceClass::stretch ? 1.0 : std::sqrt(3.0), 1e-14);
}

template <class Build>
std::string refusal(const Build& build) {
  try {
    build();
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(ClothSprings, NodesInOnePlaceAreRefusedByName) {
  const GridShape g{.nu = 3, .nv = 3};
  TriangleMesh mesh = make_grid(g);
  mesh.positions[4] = mesh.positions[5];
  for (const std::string& text :
       {refusal([&] { grid_springs(g, mesh.positions, {}, 0, "curtain"); }),
        refusal([&] { mesh_springs(mesh, {}, 0, "curtain"); })}) {
    EXPECT_NE(text.find("cloth 'curtain'"), std::string::npos) << text;
    EXPECT_NE(text.find("vertices 5 and 6"), std::string::npos) << text;
    EXPECT_NE(text.find("merge"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace taut
