#pragma once
// The solver `auto`: in each solve the method that should cost least, of
//
//   core_fast                        on the core that is the system's own, with a bound on its
//                                    iterations; the measure of the others on the paper's where
//                                    that is another: the least set-up, and few iterations far
//                                    beyond what their bound promises on all but bending: that
//                                    reaches twice as far and so costs most, and is seldom needed
//                                    in the core on all of A: a direct solve in single precision,
//                                    refined
//   upcg:projected_block_diagonal    no set-up; for soft or quiet cloth. Projected: the bound on
//                                    its condition holds for the blocks of Ã, not for those of A
//                                    restricted to the free directions
//   upcg:ic0_core, upcg:ic0          little set-up, but iterations grow with the stiffness, and
//                                    they may break down
//   block_cholesky                   direct, in double precision
//
// Work is counted (solve/solver_work.h) from the sizes of matrix and factor and from the iterations
// of a method's last solve; no clock.
//
// Choose: the least work, of the methods that have been tried. The first solve is corePCG's.
//
// Try another one now and then: first those never tried, one a solve, if the fewest iterations that
// can be hoped for would win: one on all of A; of the block diagonal a quarter of what its
// condition allows; of IC(0) of A a share of what that of the core took, the root of the condition
// that the core leaves; else three. Then such as would win with half their last iterations, after
// 32 solves, and after twice as many each time they lose (at most 256). A trial that has cost as
// much as the chosen method would is given up.
//
// Give up a method without a bound when it has cost twice what corePCG would, corePCG itself at
// twice what the direct one would.
//
// Fall back: a method that fails is not tried again for 64 solves; corePCG goes on from its last
// iterate, then the direct one.
//
// Same accuracy: the stop test's norm depends on the preconditioner, |e|_A/|x|_A <=
// sqrt(cond(M⁻¹A)) tolerance. A method whose condition (by Lanczos, from the coefficients of its
// own last solve) is above corePCG's bound gets a tolerance as much smaller; what stopped too early
// goes on with another method. core_fast proves its error after the solve,
// SolveSummary::error_bound; (error_bound/stop_value)² then is what the condition is to others.
//
// Before a method's first solve its condition is taken for that of the block diagonal
// (core/core_bound.h), a core's for the own core's bound.
//
// Deterministic. What later choices depend on is in memory(), a few numbers, so that a resumed
// simulation takes the same way.

#include <array>
#include <memory>

#include "taut/solve/solver.h"
#include "taut/solve/solver_work.h"

namespace taut {

// What solves on the core.
inline constexpr const char* auto_core_method = "core_fast";

class AutoSolver : public ConstrainedSolver {
 public:
  explicit AutoSolver(SolverOptions options);
  ~AutoSolver() override;

  std::vector<double> memory() const override;
  void restore_memory(std::span<const double> memory) override;

 protected:
  void run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) override;
  bool is_direct() const override { return last_solved_ == direct; }

 private:
  enum Method : int {
    core,
    stretch_core,
    unbent_core,
    full_core,
    block_diagonal,
    ic0_core,
    ic0,
    direct,
    method_count
  };
  // Whether its accuracy has to be learnt.
  static bool is_incomplete(Method method) {
    return method != core && method != full_core && method != direct;
  }
  static bool has_core(Method method) {
    return method == core || method == stretch_core || method == unbent_core || method == full_core;
  }
  static bool available(Method method, const SystemSize& size);
  static double first_condition(Method method, const LinearSystem& system);
  static double allowed_condition(const LinearSystem& system);

  // What is remembered of a method. All numbers are doubles, so that a memory is a list of them.
  struct Record {
    // of its last solve, or more than where it was given up; negative: never tried
    double iterations = -1.0;
    double condition = 0.0;   // of M⁻¹ A, as far as its solves have shown; 0: none yet
    double next_trial = 0.0;  // number of the solve from which on it may be tried
    double patience = 32.0;   // solves between trials
    double factor_nonzeros = 0.0, factor_flops = 0.0, left_out_nonzeros = 0.0;
    // of the preconditioner, in its last solve; of a core's factor: once more in double precision
    double preparations = 1.0;
  };
  enum class Attempt { solved, given_up, failed };

  struct Solve;  // of one system
  MethodWork work(Method method, const SystemSize& size) const;
  double expected_work(Method method, const SystemSize& size) const;
  bool tried(Method method) const { return records_[method].iterations >= 0.0; }
  Method choose(const SystemSize& size) const;
  // The rival to try, or `chosen` itself if none.
  Method rival_of(Method chosen, const Solve& solve);
  double least_iterations(Method method, const Solve& solve) const;
  // Iterations of a method until it has cost `limit`.
  int budget(Method method, const SystemSize& size, double limit) const;
  double tolerance_for(Method method, const LinearSystem& system) const;
  Attempt attempt(Method method, int most_iterations, Solve& solve);
  void learn(Method method, const SolveSummary& summary, const CgCoefficients& record,
             double tolerance, Solve& solve);
  void note_trial(Method method, bool won);
  ConstrainedSolver& solver(Method method);
  std::span<const std::uint8_t> all_blocks(const BlockCsr& a);

  std::array<Record, method_count> records_;
  Method last_solved_ = core;  // what solved the last system that was solved
  double solves_ = 0.0;
  std::array<std::unique_ptr<ConstrainedSolver>, method_count> solvers_;
  std::vector<double> guess_;
  std::vector<std::uint8_t> all_blocks_;  // a core's mask
};

}  // namespace taut
