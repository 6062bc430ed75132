#pragma once
// Estimates from a scene's numbers alone, of what the time step and the solver will meet.
// docs/mathematics.md, 1 and 5.
//
//   m        kg, mass of a node inside the cloth
//   λ        N/m, the largest eigenvalue of the 3x3 block D_R,i that the shear and bend springs
//            give a node of the flat cloth at rest. A spring there is k e eᵀ. On a grid with cells
//            a x b the four diagonals add up to 4 k_shear diag(a², b²)/(a² + b²), the four bend
//            springs to 2 k_bend I in the plane: λ = 4 k_shear max(a², b²)/(a² + b²) + 2 k_bend,
//            for squares 2 (k_shear + k_bend). A mesh has about six bend springs a node, evenly
//            spread: λ = 3 k_bend.
//   ρ        (h² λ + h λ_damping) / m: bounds the paper's core, cond <= 2 (1 + ρ)
//   explicit stability (IMEX treats those springs explicitly): λmax(L_R) <= 2 λ, and h² λmax / m <
//   4, so h² λ / (2m) < 1; for
//            squares and shear alone that is h² k_shear / m < 1

#include "taut/mesh/triangle_mesh.h"
#include "taut/scene/scene.h"

namespace taut {

struct ClothEstimate {
  double area = 0.0;       // m²
  double mass = 0.0;       // kg, all of it
  double node_mass = 0.0;  // m
  // m, longest distance of neighbours on a grid, mean edge length of a mesh
  double spacing = 0.0;
  double rest_stiffness = 0.0;  // λ
  double rest_damping = 0.0;    // N·s/m, the same with the springs' dampings

  // Largest time step (s) at which shear and bend springs may be explicit on flat cloth.
  double explicit_step() const;
  double rho(const TimeOptions& time) const;
  // Iterations of the paper's core to reduce the A-norm of the error by `tolerance`: ½ sqrt(2
  // (1+ρ)) ln(2/tolerance).
  double core_iterations(const TimeOptions& time, double tolerance) const;
};

// `shape` is start_shape (cloth_shape.h).
ClothEstimate estimate(const Cloth& cloth, const TriangleMesh& shape);

}  // namespace taut
