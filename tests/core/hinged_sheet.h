#pragma once
// A small sheet of stretch springs and bending hinges, in any state: its assembler, matrices and
// cores.

#include <Eigen/Eigenvalues>
#include <memory>

#include "linalg/random_matrix.h"
#include "taut/core/core_bound.h"
#include "taut/core/element_core.h"
#include "taut/element/cloth_springs.h"
#include "taut/element/quadratic_bending.h"

namespace taut::test {

struct HingedMaterial {
  double k_stretch = 6000, k_bend = 1e-6;  // N/m, N m
  double h = 5e-3, node_mass = 9.5e-6;
  Index nu = 4, nv = 3;
  double spacing = 0.0125;  // m
};

// The smallest and largest eigenvalue of P⁻¹A.
inline std::pair<double, double> spectrum(const Eigen::MatrixXd& a, const Eigen::MatrixXd& p) {
  const Eigen::VectorXd values = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(
                                     a, p, Eigen::EigenvaluesOnly | Eigen::Ax_lBx)
                                     .eigenvalues();
  return {values.minCoeff(), values.maxCoeff()};
}

struct HingedSheet {
  HingedMaterial material;
  TriangleMesh rest;
  std::vector<std::unique_ptr<ForceModel>> models;
  std::vector<double> masses;
  std::unique_ptr<Assembler> assembler;
  BlockCsr a;
  std::vector<Vec3> b;

  explicit HingedSheet(const HingedMaterial& m) : material(m) {
    GridShape shape{.nu = m.nu, .nv = m.nv};
    shape.u = m.spacing * (m.nu - 1) * Vec3::UnitX();
    shape.v = m.spacing * (m.nv - 1) * Vec3::UnitZ();
    rest = make_grid(shape);
    SpringMaterial springs;
    springs.k_stretch = m.k_stretch;
    for (auto& model : mesh_springs(rest, springs, 0, "sheet"))
      if (model->force_class() == ForceClass::stretch) models.push_back(std::move(model));
    models.push_back(
        std::make_unique<QuadraticBending>(bending_hinges(rest, m.k_bend, 0.0, 0, "sheet")));
    masses.assign(rest.positions.size(), m.node_mass);
    b.resize(masses.size());
    assembler =
        std::make_unique<Assembler>(nodes(), pointers(), std::vector<bool>(models.size(), true));
    a = BlockCsr(assembler->pattern());
    assemble(rest.positions);
  }

  Index nodes() const { return static_cast<Index>(masses.size()); }
  std::vector<const ForceModel*> pointers() const {
    std::vector<const ForceModel*> all;
    for (const auto& model : models) all.push_back(model.get());
    return all;
  }
  void assemble(std::span<const Vec3> x) {
    const std::vector<Vec3> still(x.size(), Vec3::Zero());
    ForceRequest request;
    request.x = x, request.v = still, request.force = material.h;
    request.matrix_stiffness = material.h * material.h;
    assembler->assemble(std::vector<ForceRequest>(models.size(), request), {masses, 1.0, {}, 0.0},
                        a, b);
  }
  // The core of the stretch springs, which leaves every hinge out.
  ElementCore stretch_core() const {
    return {"stretch", assembler->core_mask(ForceClass::stretch), *assembler};
  }
  CoreRest rest_of(const ElementCore& core) const {
    CoreRest result;
    measure_rests({&core, 1}, *assembler, a, masses, true, {&result, 1});
    return result;
  }
};

// Adds D_R.
inline Eigen::MatrixXd with_diagonal(Eigen::MatrixXd p, std::span<const Mat3> diagonal) {
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    p.block<3, 3>(at, at) += diagonal[i];
  }
  return p;
}

}  // namespace taut::test
