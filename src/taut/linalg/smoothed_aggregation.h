#pragma once
// Algebraic multigrid by smoothed aggregation, one V-cycle as M_p⁻¹ (Vaněk, Mandel & Brezina 1996;
// for cloth: Tamstorf, Jones & McCormick 2015).
//
//   P̂         the near-null space of each group of nodes, orthonormalised
//   P          (I - ω D⁻¹ A) P̂, D the diagonal blocks of A, ω = 4/(3 λ), λ ≈ λmax(D⁻¹ A)
//   coarser    Pᵀ A P, and so on; at `coarsest_nodes` nodes or fewer a dense Cholesky
//   smoother   Chebyshev polynomial of degree `smoother_degree` in D⁻¹ A over
//              [λ/`smoother_range`, 1.1 λ], before and after: symmetric, so it suits CG
//
// The near-null space makes the method: with the rigid motions (linalg/near_null_space.h) a coarse
// node has six unknowns, three translations and three rotations; without one given, it is a
// translation along each unknown's axis. Dependent columns in a group (a straight line of nodes
// does not resist three rotations) are dropped. Nodes of 0 to 3 unknowns; as scalars where no node
// has more than one. Parallel, with the same bits for any number of threads.

#include "taut/linalg/near_null_space.h"
#include "taut/linalg/preconditioner.h"

namespace taut {

struct AmgOptions {
  // neighbours i, j count as coupled when |A_ij| >= strength sqrt(|A_ii| |A_jj|) (Frobenius norms)
  double strength = 0.0;
  int smoother_degree = 2;
  double smoother_range = 10.0;
  Index coarsest_nodes = 40;
  int most_levels = 12;
};

class AmgHierarchy;

class SmoothedAggregation : public Preconditioner {
 public:
  explicit SmoothedAggregation(AmgOptions options = {});
  ~SmoothedAggregation() override;
  // For the unknowns of the next update()'s matrix; 1, 3 or 6 modes. Empty: as above.
  void set_near_null_space(NearNullSpace space) override { space_ = std::move(space); }
  Status update(const BlockCsr& a) override;
  void apply(std::span<const double> r, std::span<double> z) const override;
  Offset bytes() const override;

  // For reports and tests: nodes of each level, finest first; blocks of all levels' matrices over
  // those of the finest.
  std::vector<Index> level_nodes() const;
  double operator_complexity() const;

 private:
  AmgOptions options_;
  NearNullSpace space_;
  std::unique_ptr<AmgHierarchy> hierarchy_;
};

}  // namespace taut
