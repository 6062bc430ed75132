#pragma once
// A few masses and springs with a Stepper around them, solved directly: what is tested is the
// integrator.

#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "taut/element/spring_model.h"
#include "taut/step/stepper.h"

namespace taut::test {

inline SolverOptions direct_solver() {
  SolverOptions options;
  options.name = "eigen_ldlt";
  return options;
}

struct SmallSystem {
  std::vector<double> masses;
  std::vector<std::unique_ptr<SpringModel>> models;
  Vec3 gravity = Vec3::Zero();
  double drag = 0.0;  // kg/s a node
  NewtonOptions newton{.tolerance = 1e-10, .max_iterations = 5000};
  State state;
  ConstraintSet constraints;
  std::unique_ptr<Stepper> stepper;

  void add_node(double mass, const Vec3& x, const Vec3& v = Vec3::Zero()) {
    masses.push_back(mass);
    state.x.push_back(x);
    state.v.push_back(v);
  }
  void add_springs(ForceClass force_class, SpringLawKind law, std::vector<Spring> springs) {
    models.push_back(std::make_unique<SpringModel>(force_class, law, std::move(springs)));
  }
  Index nodes() const { return static_cast<Index>(masses.size()); }
  void start(IntegratorKind integrator) {
    std::vector<const ForceModel*> all;
    for (const auto& model : models) all.push_back(model.get());
    ExternalForces external(masses, gravity, {});
    for (Index i = 0; i < nodes(); ++i) external.set_drag(i, drag);
    stepper = std::make_unique<Stepper>(nodes(), all, std::move(external), integrator,
                                        direct_solver(), newton);
    constraints.reset(nodes());
  }
  void pin(Index node, const Vec3& displacement = Vec3::Zero()) {
    constraints.fix(node, displacement);
  }
  // One step under the constraints as they are.
  void step(double h) {
    stepper->begin(state, h);
    const SolveSummary summary = stepper->solve(constraints, {});
    ASSERT_TRUE(summary.status.ok()) << summary.status.message;
    stepper->commit(state);
  }
  void run(double h, int steps) {
    for (int k = 0; k < steps && !testing::Test::HasFatalFailure(); ++k) step(h);
  }

  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < masses.size(); ++i) sum += masses[i] * state.v[i];
    return sum;
  }
  Vec3 angular_momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < masses.size(); ++i) sum += masses[i] * state.x[i].cross(state.v[i]);
    return sum;
  }
};

inline constexpr std::array all_integrators{IntegratorKind::semi_implicit_euler,
                                            IntegratorKind::imex, IntegratorKind::imex_adaptive,
                                            IntegratorKind::bdf2, IntegratorKind::newton};

}  // namespace taut::test
