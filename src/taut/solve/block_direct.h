#pragma once
// Direct solution of the reduced system (paper Section 4) by Taut's own block Cholesky
// factorisation in double precision, straight from A (solve/full_space.h): ordering and symbolic
// work once per topology, whatever contacts do and whatever SolverOptions::reuse_analysis says. The
// forward solve is done while the factor is computed; solve_again() takes the last factor. One step
// of iterative refinement where the residual asks for it.

#include "taut/linalg/block_cholesky.h"
#include "taut/solve/solver.h"

namespace taut {

class BlockDirect : public ConstrainedSolver {
 public:
  explicit BlockDirect(SolverOptions options) : ConstrainedSolver(std::move(options)) {}

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;
  void run_again(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  void finish(const LinearSystem& system, std::span<double> x, SolveSummary& summary);
  void refine(const LinearSystem& system, std::span<double> x);

  std::shared_ptr<const BlockPattern> pattern_;
  BlockCholesky factor_{CholeskyPrecision::double_precision};
  std::vector<double> load_, free_part_;
};

}  // namespace taut
