#pragma once
// Quadratic bending of sheets that hardly stretch (Bergou, Wardetzky, Harmon, Zorin & Grinspun
// 2006, "A Quadratic Bending Model for Inextensible Surfaces"): one element a hinge, two triangles
// with a common edge 0 1 and opposite corners 2, 3.
//
//   E = ½ k |w|²,  w = Σ c_i x_i       k = 3 k_b/(area of both triangles), N/m;  K_ij = k c_i c_j I
//   f_i = -c_i (k w + d ẇ)             d: the same of k_d, N s/m
//   c_0 = cot α_1 + cot β_1, c_1 = cot α_0 + cot β_0, c_2 = -cot α_0 - cot α_1, c_3 likewise of β;
//   α_0, α_1, β_0, β_1: the angles of either triangle at nodes 0 and 1, at rest
//
// k_b is the bending rigidity, N m: E approximates ½ k_b ∫ (κ_1 + κ_2)². K is the same in every
// state. Σ c_i = 0, and w = 0 for affine images of a flat rest shape; a curved one is pulled flat.
// The blocks of 0 1 and of 2 3 mostly have the sign opposite to a spring's.

#include <array>

#include "taut/element/force_model.h"
#include "taut/mesh/triangle_mesh.h"

namespace taut {

struct BendingHinge {
  std::array<Index, 4> node{};
  std::array<double, 4> weight{};  // c
  double stiffness = 0.0;          // k, N/m
  double damping = 0.0;            // d, N s/m
};

// One for each inner edge of a mesh at rest; rigidity k_b >= 0 (N m), damping k_d >= 0 (N m s).
// Nodes are the mesh's, shifted by first_node. A triangle without area is an InputError that names
// it.
std::vector<BendingHinge> bending_hinges(const TriangleMesh& rest, double rigidity, double damping,
                                         Index first_node, const std::string& cloth_name);

class QuadraticBending : public ForceModel {
 public:
  explicit QuadraticBending(std::vector<BendingHinge> hinges) : hinges_(std::move(hinges)) {}

  ForceClass force_class() const override { return ForceClass::bend; }
  Index nodes_per_element() const override { return 4; }
  Index blocks_per_element() const override { return 10; }
  Index block_count() const override { return 10 * static_cast<Index>(hinges_.size()); }
  Index vector_count() const override { return 4 * static_cast<Index>(hinges_.size()); }
  void connect(ConnectionSink& sink) const override;
  void evaluate(const ForceRequest& request, std::span<double> blocks,
                std::span<Vec3> vectors) const override;
  void bound_blocks(double matrix_stiffness, double matrix_damping,
                    std::span<double> bounds) const override;
  double energy(std::span<const Vec3> x) const override;
  Index collapsed(std::span<const Vec3>) const override { return 0; }

  std::span<const BendingHinge> hinges() const { return hinges_; }

 private:
  std::vector<BendingHinge> hinges_;
};

}  // namespace taut
