#pragma once
// The node-wise preconditioners of MPCG, and the same restricted to the free directions for uPCG:
//
//   scalar   M_p = diag(A)                 block   M_p = the 3x3 diagonal blocks of A
//   full space     z = M_p⁻¹ r             reduced space   z_i = U_iᵀ M_p,i⁻¹ U_i r_i
//
// With the second, uPCG takes exactly MPCG's steps (Ascher & Boxerman 2003; docs/mathematics.md,
// 3.2).

#include "taut/constraint/constraint_set.h"
#include "taut/linalg/preconditioner.h"

namespace taut {

enum class NodeDiagonal { scalar, block };

// For use with the reduced matrix; built from the full one.
class ProjectedNodePreconditioner : public Preconditioner {
 public:
  ProjectedNodePreconditioner(NodeDiagonal kind, const ConstraintSet* constraints)
      : kind_(kind), constraints_(constraints) {}
  // a is the full matrix A. The constraints are read here and not kept in use afterwards.
  Status update(const BlockCsr& a) override;
  void apply(std::span<const double> r, std::span<double> z) const override;
  Offset bytes() const override {
    return static_cast<Offset>((scalar_.size() + block_.size()) * sizeof(double));
  }

 private:
  struct Node {
    Index dof;
    Index dim;
    Index block;  // into block_, or -1: scalar_ at dof
  };
  NodeDiagonal kind_;
  const ConstraintSet* constraints_;
  std::vector<Node> nodes_;     // nodes that do not use scalar_
  std::vector<double> scalar_;  // n; 0 where a block acts instead
  std::vector<double> block_;
};

}  // namespace taut
