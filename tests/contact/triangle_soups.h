#pragma once
// Surfaces for tests of the broad phase and of intersections.

#include <random>

#include "taut/contact/collision_surface.h"
#include "taut/mesh/grid.h"

namespace taut::test {

struct Soup {
  std::vector<Vec3> x0, x1;
  CollisionSurface surface;
};

inline Vec3 anywhere(std::mt19937& random, double bound) {
  std::uniform_real_distribution<double> any(-bound, bound);
  return Vec3(any(random), any(random), any(random));
}

// A crumpled sheet of nu x nv nodes, a solid of loose triangles in it, and a small second sheet;
// all move by up to `motion` (m).
inline Soup make_soup(std::uint32_t seed, Index nu, Index nv, Index solid_triangles, double noise,
                      double motion) {
  std::mt19937 random(seed);
  Soup soup;
  GridShape shape;
  shape.nu = nu;
  shape.nv = nv;
  TriangleMesh sheet = make_grid(shape);
  for (Vec3& x : sheet.positions)
    x = Vec3(x[0] + 0.1 * std::sin(9 * x[2]), 0.2 * std::sin(7 * x[0]), 0.5 * x[2]) +
        anywhere(random, noise);
  shape.nu = shape.nv = 3;
  shape.origin = Vec3(0.3, 0.05, 0.1);
  const TriangleMesh second = make_grid(shape);
  TriangleMesh solid;
  for (Index t = 0; t < solid_triangles; ++t) {
    const Vec3 centre = 0.5 * (Vec3::Ones() + anywhere(random, 1.0));
    for (int k = 0; k < 3; ++k) solid.positions.push_back(centre + anywhere(random, 0.1));
    solid.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  std::vector<SurfacePart> parts;
  for (const TriangleMesh* mesh :
       std::initializer_list<const TriangleMesh*>{&sheet, &solid, &second}) {
    parts.push_back({static_cast<Index>(mesh->positions.size()), mesh->triangles, mesh == &solid});
    soup.x0.insert(soup.x0.end(), mesh->positions.begin(), mesh->positions.end());
  }
  soup.surface = join_surfaces(parts);
  soup.x1 = soup.x0;
  for (Vec3& x : soup.x1) x += anywhere(random, motion);
  return soup;
}

}  // namespace taut::test
