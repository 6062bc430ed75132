// Order of accuracy, against a classical Runge-Kutta solution of the same springs with steps so
// small that its error does not show; and where IMEX's explicit springs become unstable.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <stdexcept>

#include "step/small_system.h"
#include "taut/element/cloth_springs.h"

namespace taut {
namespace {

// A chain of three below a pin, pulled tight by gravity, swinging and bouncing: every spring stays
// stretched.
test::SmallSystem swinging() {
  test::SmallSystem system;
  system.gravity = Vec3(0, 0, -9.81);
  std::vector<Spring> stretch;
  const std::array depth{0.0, 0.96, 1.86, 2.70};  // near equilibrium
  for (Index i = 0; i <= 3; ++i) {
    system.add_node(0.1 + 0.05 * i, Vec3(0.02 * i, -0.01 * i * i, -depth[i]),
                    Vec3(0.1 * i, 0.05 * i, 0.02 * i));
    if (i > 0) stretch.push_back({i - 1, i, {.rest_length = 0.8, .stiffness = 30.0 + 5.0 * i}});
  }
  system.add_springs(ForceClass::stretch, SpringLawKind::buckling, stretch);
  system.add_springs(ForceClass::shear, SpringLawKind::buckling,
                     {{0, 2, {.rest_length = 1.7, .stiffness = 4.0}},
                      {1, 3, {.rest_length = 1.6, .stiffness = 3.0}}});
  return system;
}

using Motion = std::pair<std::vector<Vec3>, std::vector<Vec3>>;

std::vector<Vec3> acceleration(const test::SmallSystem& system, const std::vector<Vec3>& x) {
  std::vector<Vec3> a(x.size(), system.gravity);
  for (const auto& model : system.models)
    for (const auto& [i, j, p] : model->springs()) {
      const SpringResponse r = spring_response(model->law(), p, x[j] - x[i], Vec3::Zero());
      if (r.force.norm() == 0.0)
        throw std::runtime_error("a slack spring: the test would say nothing");
      a[i] += r.force / system.masses[i];
      a[j] -= r.force / system.masses[j];
    }
  a[0].setZero();  // pinned
  return a;
}

Motion runge_kutta(const test::SmallSystem& system, double time, int steps) {
  std::vector<Vec3> x = system.state.x, v = system.state.v;
  v[0].setZero();
  const double h = time / steps;
  const std::size_t n = x.size();
  for (int k = 0; k < steps; ++k) {
    std::vector<Vec3> dx(n, Vec3::Zero()), dv(n, Vec3::Zero()), at = x, speed = v;
    for (const auto& [next, weight] : {std::pair{0.5, 1.0}, {0.5, 2.0}, {1.0, 2.0}, {0.0, 1.0}}) {
      const std::vector<Vec3> a = acceleration(system, at), moving = speed;
      for (std::size_t i = 0; i < n; ++i) {
        dx[i] += weight / 6.0 * h * moving[i];
        dv[i] += weight / 6.0 * h * a[i];
        at[i] = x[i] + next * h * moving[i];
        speed[i] = v[i] + next * h * a[i];
      }
    }
    for (std::size_t i = 0; i < n; ++i) x[i] += dx[i], v[i] += dv[i];
  }
  return {x, v};
}

TEST(Order, EulerAndImexAreOfOrderOneAndBdf2OfOrderTwo) {
  constexpr double time = 0.8;
  const Motion exact = runge_kutta(swinging(), time, 2000);
  const auto error = [&](IntegratorKind kind, int steps) {
    test::SmallSystem system = swinging();
    system.start(kind);
    system.pin(0);
    system.run(time / steps, steps);
    double sum = 0.0;
    for (std::size_t i = 0; i < exact.first.size(); ++i)
      sum += (system.state.x[i] - exact.first[i]).squaredNorm() +
             (system.state.v[i] - exact.second[i]).squaredNorm();
    return std::sqrt(sum);
  };
  for (const IntegratorKind kind : test::all_integrators) {
    const int steps = kind == IntegratorKind::bdf2 ? 200 : 1600;
    const double e1 = error(kind, steps), e2 = error(kind, 2 * steps), e3 = error(kind, 4 * steps);
    const double order = kind == IntegratorKind::bdf2 ? 2.0 : 1.0;
    EXPECT_NEAR(std::log2(e1 / e2), order, 0.15) << name_of(kind) << ": " << e1 << ", " << e2;
    EXPECT_NEAR(std::log2(e2 / e3), order, 0.15) << name_of(kind) << ": " << e2 << ", " << e3;
  }
}

// Shear springs alone on a flat square grid, explicit under IMEX: v += h f/m, x += h v is stable
// for h² λmax/m < 4, and λmax <= 4 k_shear (four diagonals a node, L <= 2 D), hence "h² k_shear/m <
// 1". On a grid of some size the bound is nearly met.
TEST(Imex, IsStableUpToItsBoundAndNotBeyond) {
  constexpr double mass = 0.01, k_shear = 0.3;
  const GridShape shape{.nu = 9, .nv = 9};
  const TriangleMesh mesh = make_grid(shape);
  SpringMaterial material{.k_stretch = 0.0, .k_shear = k_shear, .k_bend = 0.0};
  material.compression = Compression::linear;
  const auto springs = grid_springs(shape, mesh.positions, material, 0, "sheet");
  const auto shear = springs[1]->springs();

  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * 81, 3 * 81);
  for (const auto& [i, j, p] : shear) {
    const Mat3 block = spring_response(SpringLawKind::linear, p,
                                       mesh.positions[j] - mesh.positions[i], Vec3::Zero())
                           .stiffness;
    for (const auto& [r, c, sign] :
         {std::tuple{i, i, 1.0}, {j, j, 1.0}, {i, j, -1.0}, {j, i, -1.0}})
      k.block<3, 3>(3 * r, 3 * c) += sign * block;
  }
  const double largest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly)
                             .eigenvalues()
                             .maxCoeff();
  EXPECT_LE(largest, 4.0 * k_shear);
  EXPECT_GT(largest, 3.7 * k_shear);

  const auto kinetic_after = [&](IntegratorKind kind, double h, int steps) {
    test::SmallSystem system;
    // So small that the sheet stays flat to first order; the pattern of the fastest mode, and
    // something of all others.
    for (Index i = 0; i < 81; ++i) {
      const double sign = (i % 9 + i / 9) % 2 == 0 ? 1.0 : -1.0, other = i % 2 == 0 ? 1.0 : -0.7;
      system.add_node(
          mass, mesh.positions[i],
          1e-9 * Vec3(sign + 0.1 * other, 0.3 * other, sign * ((i % 9) % 2 ? 1.0 : -1.0)));
    }
    system.add_springs(ForceClass::shear, SpringLawKind::linear, {shear.begin(), shear.end()});
    system.start(kind);
    system.run(h, steps);
    double sum = 0.0;
    for (const Vec3& v : system.state.v) sum += 0.5 * mass * v.squaredNorm();
    return sum / (0.5 * mass * 81 * 1e-18);
  };
  const double limit = 2.0 * std::sqrt(mass / largest);
  EXPECT_LT(kinetic_after(IntegratorKind::imex, 0.98 * limit, 500), 1e4)
      << "bounded: symplectic Euler's energy swells near its limit, but does not grow";
  EXPECT_GT(kinetic_after(IntegratorKind::imex, 1.02 * limit, 50), 1e10);
  EXPECT_LT(kinetic_after(IntegratorKind::semi_implicit_euler, 1.02 * limit, 500), 3.0)
      << "implicit: no bound";
}

}  // namespace
}  // namespace taut
