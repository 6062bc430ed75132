#include "taut/step/euler.h"

namespace taut {

void SemiImplicitEuler::assemble(Assembler& assembler, const ExternalForces& external,
                                 const State& state, double h, BlockCsr& a,
                                 std::span<Vec3> b) const {
  // h (f - h K v): K's operand is -h² v. It is shared by all models, so it is formed once.
  std::vector<Vec3> operand(state.v.size());
  for (std::size_t i = 0; i < operand.size(); ++i) operand[i] = -h * h * state.v[i];
  std::vector<ForceRequest> requests;
  for (std::size_t m = 0; m < assembler.models().size(); ++m) {
    ForceRequest request;
    request.x = state.x, request.v = state.v;
    request.force = h;
    if (assembler.is_implicit(m)) {
      request.matrix_damping = h;
      request.matrix_stiffness = h * h;
      request.stiffness_operand = operand;
    }
    requests.push_back(request);
  }
  assembler.assemble(requests, {external.masses(), 1.0, external.damping(), h}, a, b);
  for (std::size_t i = 0; i < b.size(); ++i) b[i] += h * external.force()[i];
}

bool ImplicitEuler::relinearise(Assembler& assembler, const ExternalForces& external, double h,
                                std::span<const Vec3> dv, std::span<const Vec3> x_end,
                                std::span<const Vec3> v_end, BlockCsr& a, std::span<Vec3> b) const {
  std::vector<Vec3> stiffness_operand(dv.size()), damping_operand(dv.size());
  for (std::size_t i = 0; i < dv.size(); ++i) {
    damping_operand[i] = h * dv[i];
    stiffness_operand[i] = h * h * dv[i];
  }
  ForceRequest request;
  request.x = x_end, request.v = v_end;
  request.force = h;
  request.matrix_damping = h;
  request.matrix_stiffness = h * h;
  request.stiffness_operand = stiffness_operand;
  request.damping_operand = damping_operand;
  const std::vector<ForceRequest> requests(assembler.models().size(), request);
  assembler.assemble(requests, {external.masses(), 1.0, external.damping(), h}, a, b);
  for (std::size_t i = 0; i < b.size(); ++i) {
    b[i] += h * external.force()[i];
    if (!external.damping().empty()) b[i] += external.damping()[i] * damping_operand[i];
  }
  return true;
}

void SemiImplicitEuler::prescribe(const ConstraintSet& constraints, const State& state, double h,
                                  std::span<Vec3> z) const {
  for (Index i = 0; i < constraints.nodes(); ++i)
    z[i] =
        constraints.ndof(i) == 3
            ? Vec3(Vec3::Zero())
            : Vec3(constraints.constrained_part(i, constraints.displacement(i) / h - state.v[i]));
}

void SemiImplicitEuler::finish(const State& state, double h, std::span<const Vec3> dv,
                               std::span<Vec3> x_end, std::span<Vec3> v_end) const {
  for (std::size_t i = 0; i < dv.size(); ++i) {
    v_end[i] = state.v[i] + dv[i];
    x_end[i] = state.x[i] + h * v_end[i];
  }
}

}  // namespace taut
