#pragma once
// What takes over where a solve fails: the next method of a chain, until one succeeds.
//
//   FallbackChain chain(options)    options: of all methods of the chain, but for the name
//   chain.solve(first, system, x)   the answer of `first`, or of the first of the chain to succeed
//
// Methods that this program lacks are left out, and so is the one that has just failed. The
// summary's `fallbacks` counts those that took over. Where all fail, x is the last one's and its
// status names each of them with its reason.

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "taut/solve/solver.h"

namespace taut {

// Direct methods, Taut's own first: "block_cholesky", then "eigen_ldlt", which shares no code with
// it.
std::span<const char* const> fallback_chain();

class FallbackChain {
 public:
  explicit FallbackChain(SolverOptions options,
                         std::span<const char* const> names = fallback_chain());

  SolveSummary solve(ConstrainedSolver& first, const LinearSystem& system, std::span<double> x);
  // For a caller with more to do in a solve: solve_with(solver) does all of it.
  SolveSummary solve(ConstrainedSolver& first,
                     const std::function<SolveSummary(ConstrainedSolver&)>& solve_with);

 private:
  SolverOptions options_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<ConstrainedSolver>> solvers_;  // made when first needed
};

}  // namespace taut
