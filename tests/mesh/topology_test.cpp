#include "taut/mesh/topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "taut/base/error.h"
#include "taut/mesh/grid.h"

namespace taut {
namespace {

TriangleMesh fan_of(std::vector<Vec3> positions, std::vector<Triangle> triangles) {
  return {std::move(positions), std::move(triangles), {}};
}

TriangleMesh two_triangles() {
  return fan_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}});
}

TEST(Topology, TwoTrianglesShareOneHinge) {
  const Topology topology = build_topology(two_triangles());
  EXPECT_EQ(topology.edges, (std::vector<Edge>{{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}}));
  EXPECT_EQ(topology.boundary_edges, (std::vector<Edge>{{0, 1}, {0, 2}, {1, 3}, {2, 3}}));
  ASSERT_EQ(topology.hinges.size(), 1u);
  EXPECT_EQ(topology.hinges[0].edge, (Edge{1, 2}));
  EXPECT_EQ(topology.hinges[0].opposite, (std::array<Index, 2>{0, 3}));
  EXPECT_EQ(topology.hinges[0].triangle, (std::array<Index, 2>{0, 1}));
  EXPECT_TRUE(topology.non_manifold_edges.empty());
}

TEST(Topology, GridCountsAndEuler) {
  GridShape shape;
  shape.nu = 7, shape.nv = 5;
  const TriangleMesh mesh = make_grid(shape);
  const Topology topology = build_topology(mesh);
  // Grid edges, one diagonal per cell; V - E + F = 1 on a disk.
  EXPECT_EQ(topology.edges.size(), 6u * 5 + 7 * 4 + 6 * 4);
  EXPECT_EQ(mesh.positions.size() - topology.edges.size() + mesh.triangles.size(), 1u);
  EXPECT_EQ(topology.boundary_edges.size(), 2u * (6 + 4));
  EXPECT_EQ(topology.hinges.size(), topology.edges.size() - topology.boundary_edges.size());
  EXPECT_TRUE(std::is_sorted(topology.edges.begin(), topology.edges.end()));
  for (const Hinge& hinge : topology.hinges)
    for (int s = 0; s < 2; ++s) {
      const Triangle& t = mesh.triangles[hinge.triangle[s]];
      EXPECT_EQ((std::set<Index>{t.begin(), t.end()}),
                (std::set<Index>{hinge.edge.a, hinge.edge.b, hinge.opposite[s]}));
    }
}

TEST(Topology, DoesNotDependOnWinding) {
  TriangleMesh mesh = two_triangles();
  const Topology before = build_topology(mesh);
  std::swap(mesh.triangles[1][0], mesh.triangles[1][2]);
  EXPECT_EQ(build_topology(mesh).edges, before.edges);
  EXPECT_EQ(build_topology(mesh).hinges[0].opposite, before.hinges[0].opposite);
}

TEST(Topology, ThreeTrianglesOnOneEdgeGetTwoHinges) {
  const TriangleMesh mesh = fan_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}},
                                   {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
  const Topology topology = build_topology(mesh);
  EXPECT_EQ(topology.non_manifold_edges, (std::vector<Edge>{{0, 1}}));
  ASSERT_EQ(topology.hinges.size(), 2u);
  EXPECT_EQ(topology.hinges[0].opposite, (std::array<Index, 2>{2, 3}));
  EXPECT_EQ(topology.hinges[1].opposite, (std::array<Index, 2>{3, 4}));
  EXPECT_EQ(topology.boundary_edges.size(), 6u);
}

TEST(Topology, DoubledTriangleGivesNoHingeOfNoLength) {
  const Topology topology =
      build_topology(fan_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {2, 1, 0}}));
  EXPECT_EQ(topology.edges.size(), 3u);
  EXPECT_TRUE(topology.hinges.empty());
  EXPECT_EQ(topology.folded_hinges, 3);
}

TEST(Topology, TriangleThatRepeatsAVertexIsLeftOut) {
  TriangleMesh mesh = two_triangles();
  const Topology before = build_topology(mesh);
  mesh.triangles.insert(mesh.triangles.begin(), {0, 3, 0});
  const Topology topology = build_topology(mesh);
  EXPECT_EQ(topology.edges, before.edges);  // no edge 0-3
  EXPECT_EQ(topology.hinges[0].triangle, (std::array<Index, 2>{1, 2}));
}

TEST(VertexAreas, AddUpToTheSheetAndSplitByThirds) {
  GridShape shape;
  shape.nu = 9, shape.nv = 4;
  shape.u = {2, 0, 1}, shape.v = {0, 3, 0};
  const std::vector<double> area = vertex_areas(make_grid(shape));
  EXPECT_NEAR(std::accumulate(area.begin(), area.end(), 0.0), 3 * std::sqrt(5.0), 1e-12);
  const std::vector<double> two = vertex_areas(two_triangles());
  EXPECT_DOUBLE_EQ(two[0], 1.0 / 6);
  EXPECT_DOUBLE_EQ(two[1], 1.0 / 3);
}

TEST(MeshFaults, EachKindIsFound) {
  TriangleMesh mesh = two_triangles();
  EXPECT_FALSE(find_faults(mesh).any());
  mesh.positions.emplace_back(2, 0, 0);  // 4: in line with 0 and 1
  mesh.positions.emplace_back(9, 9, 9);  // 5: loose
  mesh.triangles.push_back({3, 3, 1});
  mesh.triangles.push_back({0, 1, 4});
  const MeshFaults faults = find_faults(mesh);
  EXPECT_EQ(faults.repeated_vertex, (std::vector<Index>{2}));
  EXPECT_EQ(faults.zero_area, (std::vector<Index>{3}));
  EXPECT_EQ(faults.isolated_vertices, (std::vector<Index>{5}));
}

TEST(MeshFaults, SmallAndThinTrianglesAreSound) {
  EXPECT_FALSE(find_faults(fan_of({{0, 0, 0}, {1e-9, 0, 0}, {0, 1e-9, 0}}, {{0, 1, 2}})).any());
  EXPECT_FALSE(find_faults(fan_of({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-6, 0}}, {{0, 1, 2}})).any());
  EXPECT_TRUE(find_faults(fan_of({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}})).any());
}

std::string complaint(const TriangleMesh& mesh) {
  try {
    check_cloth_mesh(mesh, "shirt.obj");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CheckClothMesh, NamesTheFirstFault) {
  TriangleMesh mesh = two_triangles();
  EXPECT_EQ(complaint(mesh), "");
  mesh.positions.emplace_back(9, 9, 9);
  EXPECT_EQ(complaint(mesh).rfind("shirt.obj: vertex 5 is in no triangle and", 0), 0u)
      << complaint(mesh);
  mesh.triangles.push_back({0, 4, 0});
  mesh.triangles.push_back({1, 1, 1});
  EXPECT_EQ(complaint(mesh).rfind(
                "shirt.obj: triangle 3 (vertices 1, 5, 1) names a vertex twice (2 in all)", 0),
            0u)
      << complaint(mesh);
}

}  // namespace
}  // namespace taut
