#pragma once
// The reduced system without forming it: solvers that read A as it is and take the constraints in
// as a basis per node (linalg/node_basis.h).
//
//   Ã = Uᵀ A U is the product prolong, A, restrict; its core, Uᵀ P U, is what BlockCholesky
//   factorises from A's blocks with that basis
//
// Vectors have 3N entries. b̂ below stands for b̃ = Uᵀ b̂; what it holds in constrained directions
// nobody reads.

#include "taut/linalg/node_basis.h"
#include "taut/solve/linear_system.h"

namespace taut {

// U of the system's constraints; Q = I without any.
NodeBasis free_basis(const LinearSystem& system);

// b̂ = b - A (I-S) z, reading A's rows at constrained nodes that move only.
void load_without_prescribed(const LinearSystem& system, std::span<double> load);

}  // namespace taut
