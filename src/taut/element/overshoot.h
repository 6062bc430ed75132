#pragma once
// How far a step's one linear solve went wrong about stretch. The linearised force of a spring acts
// along its direction e at the start of the step and knows nothing of the spring turning; a slack
// spring of the buckling law has no stiffness at all. What a spring ends longer than that:
//
//   d1          x_j - x_i at the end, m
//   foreseen    e·d1 when the spring had stiffness at the start, else L0, m
//   overshoot   max(|d1| - max(foreseen, L0), 0) / L0
//
// It shrinks with the square of the step size (turning), or linearly (a slack spring pulled taut).

#include "taut/element/spring_model.h"

namespace taut {

double spring_overshoot(SpringLawKind law, const SpringParameters& p, const Vec3& d0,
                        const Vec3& d1);
// The largest of a model's springs between x_start and x_end; not finite when a position is not.
double largest_overshoot(const SpringModel& model, std::span<const Vec3> x_start,
                         std::span<const Vec3> x_end);

}  // namespace taut
