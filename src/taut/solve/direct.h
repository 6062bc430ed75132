#pragma once
// Direct solution of the reduced system by sparse Cholesky (paper Section 4): analysis,
// factorisation, one forward and one backward solve. solve_again() takes the last factor.

#include "taut/linalg/sparse_cholesky.h"
#include "taut/solve/reduced_system.h"
#include "taut/solve/solver.h"

namespace taut {

// kept: the analysis stays while the reduced pattern does, whatever SolverOptions::reuse_analysis
// says.
enum class AnalysisUse { by_option, kept };

class Direct : public ConstrainedSolver {
 public:
  // backend: a name known to make_cholesky(), which must be there (asserted).
  Direct(SolverOptions options, const std::string& backend,
         AnalysisUse analysis = AnalysisUse::by_option);

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;
  void run_again(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;

 private:
  void solve_with_factor(const LinearSystem& system, std::span<double> x, SolveSummary& summary);

  std::unique_ptr<SparseCholesky> cholesky_;
  ReducedSystem reduced_;
  bool analyzed_ = false;
};

}  // namespace taut
