#pragma once
// Splits a constraint impulse j of a node among the normals of its contacts:
//
//   j = sum_k lambda_k n_k + tangential,     tangential orthogonal to all n_k
//
// by least squares: normals need not be orthogonal. lambda_k in N s, positive when solid k pushes
// the node away. A normal that adds less than `parallel_tolerance` to the span of the earlier ones
// gets lambda = 0, as ConstraintSet merges it. Normals may be shorter than 1 (already projected by
// pins): lambda is then still the force along the unprojected normal.

#include <span>

#include "taut/base/types.h"

namespace taut {

// Fills lambda (as many as normals) and returns the tangential part.
Vec3 split_impulse(std::span<const Vec3> normals, const Vec3& j, std::span<double> lambda);

// The part of a that is orthogonal to all normals.
Vec3 tangential_part(std::span<const Vec3> normals, const Vec3& a);

}  // namespace taut
