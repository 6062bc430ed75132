#pragma once
// BiCGSTAB (van der Vorst 1992) for a nonsymmetric A with a right preconditioner. Used for the
// paper's Eq. 10.
//
//   stop when |b - A x| <= tolerance |b|
//
// The norm is Euclidean and the residual the true one: it is recomputed before success is reported.
// Two products and two preconditioner applications an iteration. When the recurrence breaks down or
// its residual drifts from the true one, it starts afresh from the current x; after `max_restarts`
// without progress the outcome is breakdown.

#include "taut/linalg/krylov.h"
#include "taut/linalg/preconditioner.h"

namespace taut {

KrylovResult bicgstab(const LinearOperator& a, const Preconditioner& m, std::span<const double> b,
                      std::span<double> x, const KrylovOptions& options);

}  // namespace taut
