// The gradient of the contour's length against finite differences of the length itself, found pair
// by pair.

#include "taut/contact/contour_gradient.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "taut/mesh/grid.h"

namespace taut {
namespace {

// Two rough sheets that cross: a contour from border to border with corners everywhere.
struct Crossing {
  CollisionSurface surface;
  std::vector<Vec3> x;
  Index second;

  explicit Crossing(unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> u(-0.2, 0.2);
    const TriangleMesh a =
        make_grid({7, 6, Vec3(-3.1, -2.4, 0), Vec3(6, 0.3, 0.4), Vec3(0.2, 5, 1.5)});
    const TriangleMesh b =
        make_grid({6, 8, Vec3(-2.2, -3.3, -1.2), Vec3(5, 0.2, 3.1), Vec3(0.3, 7, -0.5)});
    for (const TriangleMesh* mesh : {&a, &b})
      for (const Vec3& p : mesh->positions)
        x.push_back(p + Vec3(u(generator), u(generator), u(generator)));
    second = static_cast<Index>(a.positions.size());
    surface = join_surfaces(
        std::vector<SurfacePart>{{second, a.triangles, false},
                                 {static_cast<Index>(b.positions.size()), b.triangles, false}});
  }

  // Where the edge p q goes through the triangle's plane.
  static Vec3 crossing(const Vec3& p, const Vec3& q, const Vec3& corner, const Vec3& normal) {
    const double hp = normal.dot(p - corner), hq = normal.dot(q - corner);
    return p + hp / (hp - hq) * (q - p);
  }

  double contour_length() const {
    double length = 0.0;
    for (const Triangle& s : surface.triangles)
      for (const Triangle& t : surface.triangles) {
        if (s[0] >= second || t[0] < second) continue;
        std::vector<Vec3> ends;
        for (const auto& [edges, face] : {std::pair(s, t), std::pair(t, s)}) {
          const Vec3 n = (x[face[1]] - x[face[0]]).cross(x[face[2]] - x[face[0]]);
          for (int k = 0; k < 3; ++k) {
            const Vec3 &p = x[edges[k]], &q = x[edges[(k + 1) % 3]];
            if (segment_meets_triangle(p, q, x[face[0]], x[face[1]], x[face[2]]).meets)
              ends.push_back(crossing(p, q, x[face[0]], n));
          }
        }
        if (ends.size() == 2) length += (ends[1] - ends[0]).norm();
      }
    return length;
  }

  // -d(length)/dd for the first sheet moved by d.
  Vec3 shrinking_direction() {
    BroadPhase broad_phase(surface, x);
    const EdgeFaces faces(surface);
    Vec3 sum = Vec3::Zero();
    for (const Intersection& at : find_intersections(broad_phase, x)) {
      const ContourEnd end = contour_end(surface, faces, at, x);
      sum += (end.node[0] < second ? 0.5 : -0.5) * end.gradient;
    }
    return sum;
  }
};

TEST(ContourGradient, AgreesWithFiniteDifferencesOfTheLength) {
  constexpr double step = 1e-6;
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
    Crossing crossing(seed);
    ASSERT_GT(crossing.contour_length(), 3.0);
    const Vec3 direction = crossing.shrinking_direction();
    ASSERT_GT(direction.norm(), 0.1);
    for (int c = 0; c < 3; ++c) {
      double length[2];
      for (int side = 0; side < 2; ++side) {
        Crossing moved = crossing;
        for (Index i = 0; i < crossing.second; ++i) moved.x[i][c] += side ? step : -step;
        length[side] = moved.contour_length();
      }
      EXPECT_NEAR((length[1] - length[0]) / (2 * step), -direction[c],
                  1e-6 * (1 + direction.norm()))
          << "seed " << seed << " axis " << c;
    }
  }
}

TEST(ContourGradient, WeightsGiveThePointOnBothSides) {
  Crossing crossing(7);
  BroadPhase broad_phase(crossing.surface, crossing.x);
  const EdgeFaces faces(crossing.surface);
  int ends = 0;
  for (const Intersection& at : find_intersections(broad_phase, crossing.x)) {
    const ContourEnd end = contour_end(crossing.surface, faces, at, crossing.x);
    Vec3 apart = Vec3::Zero();
    for (int k = 0; k < 5; ++k) apart += end.weight[k] * crossing.x[end.node[k]];
    EXPECT_LT(apart.norm(), 1e-12);
    ++ends;
  }
  EXPECT_GT(ends, 10);
}

TEST(ContourGradient, FacesOfEdges) {
  const Crossing crossing(1);
  const EdgeFaces faces(crossing.surface);
  std::size_t sides = 0;
  for (Index e = 0; e < crossing.surface.edge_count(); ++e) {
    EXPECT_TRUE(faces.of(e).size() == 1 || faces.of(e).size() == 2);
    sides += faces.of(e).size();
  }
  EXPECT_EQ(sides, 3 * crossing.surface.triangles.size());
}

}  // namespace
}  // namespace taut
