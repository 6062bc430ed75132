#include "taut/mesh/tube.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <numbers>

#include "taut/mesh/topology.h"

namespace taut {
namespace {

TEST(Tube, IsClosedAroundAndOpenAtTheEnds) {
  const TubeShape shape{24, 9, 0.2, 1.0};
  const TriangleMesh mesh = make_tube(shape);
  ASSERT_EQ(static_cast<Index>(mesh.positions.size()), shape.node_count());
  EXPECT_EQ(mesh.triangles.size(), 24u * 8u * 2u);
  const Topology topology = build_topology(mesh);
  EXPECT_EQ(topology.boundary_edges.size(), 2u * 24u);
  EXPECT_TRUE(topology.non_manifold_edges.empty());
  EXPECT_FALSE(find_faults(mesh).any());
}

TEST(Tube, HasTheAreaOfItsPrismAndFacesOutwards) {
  const TubeShape shape{48, 5, 0.1, 0.6};
  const TriangleMesh mesh = make_tube(shape);
  double area = 0.0;
  for (const double a : vertex_areas(mesh)) area += a;
  EXPECT_NEAR(area, 48 * 2 * 0.1 * std::sin(std::numbers::pi / 48) * 0.6, 1e-12);
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    EXPECT_GT((b - a).cross(c - a).dot(Vec3(a.x() + b.x() + c.x(), a.y() + b.y() + c.y(), 0)), 0.0);
  }
  EXPECT_DOUBLE_EQ(mesh.positions.front().z(), -0.3);
  EXPECT_DOUBLE_EQ(mesh.positions.back().z(), 0.3);
}

}  // namespace
}  // namespace taut
