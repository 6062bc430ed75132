#include "taut/scene/cloth_estimate.h"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

double total_area(const TriangleMesh& shape) {
  double area = 0.0;
  for (const auto& [a, b, c] : shape.triangles) {
    const Vec3 &x = shape.positions[a], &y = shape.positions[b], &z = shape.positions[c];
    area += 0.5 * (y - x).cross(z - x).norm();
  }
  return area;
}

double mean_edge(const TriangleMesh& shape) {
  double sum = 0.0;
  for (const Triangle& t : shape.triangles)
    for (int k = 0; k < 3; ++k)
      sum += (shape.positions[t[k]] - shape.positions[t[(k + 1) % 3]]).norm();
  return sum / (3.0 * static_cast<double>(std::max<std::size_t>(1, shape.triangles.size())));
}

}  // namespace

double ClothEstimate::explicit_step() const { return std::sqrt(2 * node_mass / rest_stiffness); }

double ClothEstimate::rho(const TimeOptions& time) const {
  // BDF2's matrix is M + (2/3) h D + (4/9) h² K.
  const double h = time.integrator == IntegratorKind::bdf2 ? time.step * 2 / 3 : time.step;
  return (h * h * rest_stiffness + h * rest_damping) / node_mass;
}

double ClothEstimate::core_iterations(const TimeOptions& time, double tolerance) const {
  return 0.5 * std::sqrt(2 * (1 + rho(time))) * std::log(2 / tolerance);
}

ClothEstimate estimate(const Cloth& cloth, const TriangleMesh& shape) {
  ClothEstimate e;
  const SpringMaterial& m = cloth.material;
  const double nodes = static_cast<double>(shape.positions.size());
  e.area = total_area(shape);
  e.mass = cloth.node_mass > 0 ? cloth.node_mass * nodes : cloth.density * e.area;
  // Choi & Ko's bend springs answer small compressions with the cap's slope.
  const double cap = m.bend_cap > 0 ? m.bend_cap : m.k_stretch;
  const double k_bend = m.bend_model == BendModel::choi_ko ? cap : m.k_bend;
  if (!cloth.is_grid()) {
    e.node_mass = e.mass / nodes;
    e.spacing = mean_edge(shape);
    e.rest_stiffness = 3 * k_bend;
    e.rest_damping = 3 * m.k_damp_bend;
    return e;
  }
  const double cells =
      static_cast<double>(cloth.grid.nu - 1) * static_cast<double>(cloth.grid.nv - 1);
  const double a = cloth.grid.u.norm() / (cloth.grid.nu - 1),
               b = cloth.grid.v.norm() / (cloth.grid.nv - 1);
  const double diagonals = 4 * std::max(a * a, b * b) / (a * a + b * b);
  e.node_mass = cloth.node_mass > 0 ? cloth.node_mass : e.mass / cells;
  e.spacing = std::max(a, b);
  e.rest_stiffness = diagonals * m.k_shear + 2 * k_bend;
  e.rest_damping = diagonals * m.k_damp_shear + 2 * m.k_damp_bend;
  return e;
}

}  // namespace taut
