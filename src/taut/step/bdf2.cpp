#include "taut/step/bdf2.h"

namespace taut {

void Bdf2::assemble(Assembler& assembler, const ExternalForces& external, const State& state,
                    double h, BlockCsr& a, std::span<Vec3> b) const {
  if (!state.has_previous) return first_step_.assemble(assembler, external, state, h, a, b);
  const double k = 4.0 * h * h / 9.0, d = 2.0 * h / 3.0;
  // D's operand: 4h²/9 v_n (f holds -D v_n, which the formula leaves out again) + 2h/9 δ.
  std::vector<Vec3> operand(state.v.size());
  for (std::size_t i = 0; i < operand.size(); ++i)
    operand[i] = k * state.v[i] + 2.0 * h / 9.0 * (state.x[i] - state.x_prev[i]);
  std::vector<ForceRequest> requests;
  for (std::size_t m = 0; m < assembler.models().size(); ++m) {
    ForceRequest request;
    request.x = state.x, request.v = state.v;
    request.force = k;
    request.matrix_damping = d;
    request.matrix_stiffness = k;
    request.damping_operand = operand;
    requests.push_back(request);
  }
  assembler.assemble(requests, {external.masses(), 1.0, external.damping(), d}, a, b);
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Vec3 delta = state.x[i] - state.x_prev[i];
    b[i] += external.masses()[i] *
                (delta / 3.0 + h / 9.0 * (8.0 * state.v[i] - 2.0 * state.v_prev[i])) +
            k * external.force()[i];
    if (!external.damping().empty()) b[i] += external.damping()[i] * operand[i];
  }
}

void Bdf2::prescribe(const ConstraintSet& constraints, const State& state, double h,
                     std::span<Vec3> z) const {
  if (!state.has_previous) return first_step_.prescribe(constraints, state, h, z);
  for (Index i = 0; i < constraints.nodes(); ++i)
    z[i] = constraints.ndof(i) == 3 ? Vec3(Vec3::Zero()) : constraints.displacement(i);
}

void Bdf2::finish(const State& state, double h, std::span<const Vec3> dx, std::span<Vec3> x_end,
                  std::span<Vec3> v_end) const {
  if (!state.has_previous) return first_step_.finish(state, h, dx, x_end, v_end);
  for (std::size_t i = 0; i < dx.size(); ++i) {
    x_end[i] = state.x[i] + dx[i];
    v_end[i] = (3.0 * dx[i] - (state.x[i] - state.x_prev[i])) / (2.0 * h);
  }
}

}  // namespace taut
