#pragma once
// Forces from outside the cloth: gravity, air drag and wind. They are block diagonal: each node's
// force depends on its own velocity only.
//
//   gravity        f_i = m_i g                          g in m/s²
//   drag           f_i = -c_i (v_i - w),  D_i = c_i I   c_i in kg/s, w the wind in m/s
//   wind pressure  f_i = (c A/3) n nᵀ (w - v_i),        c in kg/(m² s); of each triangle, area A,
//                  D_i = (c A/3) n nᵀ                   unit normal n, on each of its nodes
//   wind           w(t) = W (1 + gust sin(2π f t))
//
// Wind pressure is a linearised pressure on the side that faces the wind; its D_i is exact in v_i
// and positive semidefinite.

#include "taut/base/types.h"
#include "taut/mesh/triangle_mesh.h"

namespace taut {

struct WindOptions {
  Vec3 velocity = Vec3::Zero();  // W, m/s
  double gust = 0.0;             // share of W
  double gust_frequency = 1.0;   // f, Hz
  Vec3 at(double time) const;
  bool operator==(const WindOptions&) const = default;
};

class ExternalForces {
 public:
  ExternalForces(std::vector<double> masses, Vec3 gravity, WindOptions wind);
  // kg/s for one node.
  void set_drag(Index node, double drag) { drag_[node] = drag; }
  void set_gravity(const Vec3& gravity) { gravity_ = gravity; }
  void set_wind(const WindOptions& wind) { wind_ = wind; }
  // N, one a node, added to the others until it is set again; empty: none.
  void set_applied(std::vector<Vec3> force) { applied_ = std::move(force); }
  // Triangles (node numbers of the whole system) that feel wind pressure, and its coefficient.
  void add_wind_surface(std::span<const Triangle> triangles, double pressure);

  std::span<const double> masses() const { return masses_; }
  const Vec3& gravity() const { return gravity_; }
  const WindOptions& wind() const { return wind_; }
  std::span<const Vec3> applied() const { return applied_; }

  // Recomputes force() and damping() for this state. Serial over triangles, parallel over nodes.
  void evaluate(double time, std::span<const Vec3> x, std::span<const Vec3> v);
  std::span<const Vec3> force() const { return force_; }
  // Empty when there is neither drag nor wind pressure.
  std::span<const Mat3> damping() const { return damping_; }

 private:
  struct Surface {
    std::vector<Triangle> triangles;
    double pressure;
  };
  std::vector<double> masses_, drag_;
  Vec3 gravity_;
  WindOptions wind_;
  std::vector<Surface> surfaces_;
  std::vector<Vec3> applied_, force_;
  std::vector<Mat3> damping_;
};

}  // namespace taut
