// Sheets of springs with any stiffnesses, step size, masses and constraints: their matrix, and the
// cores.

#pragma once

#include "solve/constrained_case.h"
#include "taut/core/core_bound.h"
#include "taut/core/core_choice.h"
#include "taut/element/assembler.h"
#include "taut/element/cloth_springs.h"

namespace taut::test {

struct Material {
  double k_stretch = 6000, k_shear = 0.3, k_bend = 0.05, h = 3.67e-3, k_damp = 0.0;
  // stiffnesses from 0.01 to 100 times as much, spring by spring, masses from 0.1 to 10 times
  bool graded = false;
  double motion = 1.0;  // of the nodes from their places, in a third of the spacing
  double stretch = 1.02;
  bool askew = false;  // along no axis
  double node_mass = 9.5e-6;
  Index nodes = 15;  // along an edge
  std::string describe() const {
    return "k_stretch " + std::to_string(k_stretch) + ", k_shear " + std::to_string(k_shear) +
           ", k_bend " + std::to_string(k_bend) + ", h " + std::to_string(h) +
           (graded ? ", graded" : "");
  }
};

struct MaterialSheet : ConstrainedCase {
  Material material;
  Random random;
  std::vector<double> masses;
  std::vector<std::uint8_t> chosen, stretch, unbent;

  MaterialSheet(const Material& m, std::uint32_t seed) : material(m), random(seed) {
    GridShape shape{.nu = m.nodes, .nv = m.nodes - 1};
    shape.u = 0.025 * (shape.nu - 1) * Vec3::UnitX(),
    shape.v = 0.025 * (shape.nv - 1) * Vec3::UnitZ();
    if (m.askew) {
      const double u = shape.u.norm(), w = shape.v.norm();
      shape.u = u * Vec3(0.6, 0.5, 0.7).normalized();
      shape.v = w * shape.u.cross(Vec3(0.3, -0.8, 0.4)).normalized();
    }
    const std::vector<Vec3> rest = make_grid(shape).positions;
    std::vector<Vec3> x = rest, v(rest.size(), Vec3::Zero());
    for (Vec3& place : x) place = m.stretch * place + m.motion * 0.008 * random.direction();
    const auto factor = [&](double range) {
      return m.graded ? std::pow(range, random.uniform()) : 1.0;
    };
    for (std::size_t i = 0; i < rest.size(); ++i) masses.push_back(m.node_mass * factor(10.0));

    SpringMaterial springs;
    springs.k_stretch = m.k_stretch, springs.k_shear = m.k_shear, springs.k_bend = m.k_bend;
    springs.k_damp_stretch = springs.k_damp_shear = springs.k_damp_bend = m.k_damp;
    springs.compression = Compression::linear;
    std::vector<std::unique_ptr<SpringModel>> models;
    std::vector<const ForceModel*> all;
    for (const auto& model : grid_springs(shape, rest, springs, 0, "sheet")) {
      std::vector<Spring> own(model->springs().begin(), model->springs().end());
      for (Spring& spring : own) spring.parameters.stiffness *= factor(100.0);
      models.push_back(
          std::make_unique<SpringModel>(model->force_class(), model->law(), std::move(own)));
      all.push_back(models.back().get());
    }
    Assembler assembler(shape.node_count(), all, std::vector<bool>(all.size(), true));
    a = BlockCsr(assembler.pattern());
    ForceRequest request;
    request.x = x, request.v = v, request.force = m.h, request.matrix_stiffness = m.h * m.h,
    request.matrix_damping = m.h;
    std::vector<Vec3> force(rest.size());
    assembler.assemble(std::vector<ForceRequest>(all.size(), request), {masses, 1.0, {}, 0.0}, a,
                       force);
    stretch = unbent = assembler.core_mask(ForceClass::stretch);
    const std::vector<std::uint8_t> shear = assembler.core_mask(ForceClass::shear);
    for (std::size_t k = 0; k < unbent.size(); ++k) unbent[k] |= shear[k];
    chosen = choose_core(*a.pattern, assembler.block_bounds(m.h * m.h, m.h), masses);
    core = chosen;
    const Index n = a.dofs();
    for (const Vec3& f : force) b.insert(b.end(), {f.x(), f.y(), f.z()});
    z.assign(static_cast<std::size_t>(n), 0.0), guess.assign(static_cast<std::size_t>(n), 0.0);
    constraints.reset(a.rows());
  }

  // Every sixth node or so: all, two or one direction.
  void hold_some() {
    for (Index i = 0; i < a.rows(); ++i) {
      const Index kind = random.below(18);
      if (kind == 0) fix(i);
      if (kind == 1 || kind == 2) constrain(i, random.direction());
      if (kind == 2) constrain(i, Vec3(0.3, 0.5, 0.7));
    }
  }
  double rho(std::span<const std::uint8_t> mask) const { return remainder_ratio(a, mask, masses); }
  LinearSystem with_core(std::span<const std::uint8_t> mask) const {
    LinearSystem s = system();
    s.core = {"own", mask, rho(mask)};
    return s;
  }
  SolveSummary solve(const std::string& name, std::span<const std::uint8_t> mask,
                     double tolerance) const {
    std::vector<double> x(b.size());
    return make_solver(solver_options(name, tolerance))->solve(with_core(mask), x);
  }
};

}  // namespace taut::test
