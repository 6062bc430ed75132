#include "taut/picture/solid_mesh.h"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <numbers>

#include "taut/base/error.h"

namespace taut {

namespace {

constexpr double pi = std::numbers::pi;

void check_lengths(const char* shape, std::initializer_list<double> lengths) {
  for (const double length : lengths)
    if (!(length >= 0.0) || !std::isfinite(length))
      throw InputError(
          fmt::format("{}: length {}, expected a finite one of at least 0 m", shape, length));
}

void check_segments(const char* shape, int segments) {
  if (segments < 3)
    throw InputError(fmt::format("{}: {} segments, expected at least 3", shape, segments));
}

// Collects vertices in local coordinates and places them in the world.
class Builder {
 public:
  explicit Builder(const Isometry& pose) : pose_(pose) {}

  Index vertex(const Vec3& position, const Vec3& normal, const Vec2& texcoord) {
    solid_.mesh.positions.push_back(pose_ * position);
    solid_.normals.push_back(pose_.linear() * normal);
    solid_.mesh.texcoords.push_back(texcoord);
    return static_cast<Index>(solid_.mesh.positions.size()) - 1;
  }
  void triangle(Index a, Index b, Index c) { solid_.mesh.triangles.push_back({a, b, c}); }

  // The parallelogram corner, corner + a, corner + a + b, corner + b, seen
  // counter-clockwise along -normal.
  void quad(const Vec3& corner, const Vec3& a, const Vec3& b, const Vec3& normal) {
    const Index i = vertex(corner, normal, Vec2(0, 0));
    vertex(corner + a, normal, Vec2(1, 0));
    vertex(corner + a + b, normal, Vec2(1, 1));
    vertex(corner + b, normal, Vec2(0, 1));
    triangle(i, i + 1, i + 2);
    triangle(i, i + 2, i + 3);
  }

  // A disc at height z facing `side` (+1 or -1) along the z axis.
  void disc(double radius, double z, double side, int segments) {
    const Vec3 normal(0, 0, side);
    const Index centre = vertex(Vec3(0, 0, z), normal, Vec2(0.5, 0.5));
    for (int i = 0; i < segments; ++i) {
      const double angle = 2.0 * pi * i / segments;
      const Vec2 rim(std::cos(angle), std::sin(angle));
      vertex(Vec3(radius * rim.x(), radius * rim.y(), z), normal, 0.5 * (Vec2::Ones() + rim));
    }
    for (int i = 0; i < segments; ++i) {
      const Index a = centre + 1 + i, b = centre + 1 + (i + 1) % segments;
      if (side > 0.0)
        triangle(centre, a, b);
      else
        triangle(centre, b, a);
    }
  }

  // Two triangles per cell of rows x columns vertices whose first is `first`; columns run
  // counter-clockwise around z, rows upwards.
  void rows(Index first, int row_count, int column_count) {
    for (int r = 0; r + 1 < row_count; ++r)
      for (int c = 0; c + 1 < column_count; ++c) {
        const Index a = first + r * column_count + c, d = a + column_count;
        triangle(a, a + 1, d + 1);
        triangle(a, d + 1, d);
      }
  }

  SolidMesh take() { return std::move(solid_); }

 private:
  Isometry pose_;
  SolidMesh solid_;
};

}  // namespace

SolidMesh make_sphere_mesh(double radius, const Isometry& pose, int segments) {
  check_lengths("sphere", {radius});
  check_segments("sphere", segments);
  Builder builder(pose);
  const int bands = std::max(2, segments / 2);
  for (int r = 0; r <= bands; ++r)
    for (int c = 0; c <= segments; ++c) {
      const double latitude = pi * r / bands - 0.5 * pi, longitude = 2.0 * pi * c / segments;
      const Vec3 n(std::cos(latitude) * std::cos(longitude),
                   std::cos(latitude) * std::sin(longitude), std::sin(latitude));
      builder.vertex(radius * n, n,
                     Vec2(static_cast<double>(c) / segments, static_cast<double>(r) / bands));
    }
  builder.rows(0, bands + 1, segments + 1);
  return builder.take();
}

SolidMesh make_disc_mesh(double radius, const Isometry& pose, int segments) {
  check_lengths("disc", {radius});
  check_segments("disc", segments);
  Builder builder(pose);
  builder.disc(radius, 0.0, 1.0, segments);
  return builder.take();
}

SolidMesh make_quad_mesh(double size_x, double size_y, const Isometry& pose) {
  check_lengths("quad", {size_x, size_y});
  Builder builder(pose);
  builder.quad(Vec3(-0.5 * size_x, -0.5 * size_y, 0), Vec3(size_x, 0, 0), Vec3(0, size_y, 0),
               Vec3::UnitZ());
  return builder.take();
}

SolidMesh make_cylinder_mesh(double radius, double height, const Isometry& pose, int segments) {
  check_lengths("cylinder", {radius, height});
  check_segments("cylinder", segments);
  Builder builder(pose);
  for (int r = 0; r < 2; ++r)
    for (int c = 0; c <= segments; ++c) {
      const double angle = 2.0 * pi * c / segments;
      const Vec3 n(std::cos(angle), std::sin(angle), 0);
      builder.vertex(radius * n + Vec3(0, 0, (r - 0.5) * height), n,
                     Vec2(static_cast<double>(c) / segments, r));
    }
  builder.rows(0, 2, segments + 1);
  builder.disc(radius, 0.5 * height, 1.0, segments);
  builder.disc(radius, -0.5 * height, -1.0, segments);
  return builder.take();
}

SolidMesh make_box_mesh(const Vec3& size, const Isometry& pose) {
  check_lengths("box", {size.x(), size.y(), size.z()});
  Builder builder(pose);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      // a x b points along `axis`, so that swapping them turns the face around.
      Vec3 normal = Vec3::Zero(), a = Vec3::Zero(), b = Vec3::Zero();
      normal[axis] = side;
      a[(axis + 1) % 3] = size[(axis + 1) % 3];
      b[(axis + 2) % 3] = size[(axis + 2) % 3];
      if (side < 0.0) std::swap(a, b);
      builder.quad(0.5 * side * size[axis] * Vec3::Unit(axis) - 0.5 * (a + b), a, b, normal);
    }
  return builder.take();
}

Surface solid_surface(const SolidMesh& solid, const Colour& colour) {
  Surface surface = surface_of(solid.mesh);
  surface.name = "solid";
  surface.normals = solid.normals;
  surface.front = surface.back = colour;
  surface.translucency = 0.0;
  surface.gloss = 0.25;
  return surface;
}

}  // namespace taut
