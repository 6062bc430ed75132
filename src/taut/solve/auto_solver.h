#pragma once
// The solver `auto`: in each solve the method that should cost least by counted work
// (solve/solver_work.h), of
//
//   core_fast      on the system's own core, which has a bound; on its other_cores; on all of A
//   upcg           with projected_block_diagonal, ic0_core, ic0
//   block_cholesky
//
// It tries others now and then, gives up what costs too much, falls back on the own core and then
// on the direct method, and makes all as accurate as the own core's bound promises. Deterministic;
// what later choices depend on is in memory(). docs/design/auto.md has the rules.

#include <memory>
#include <vector>

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
  bool is_direct() const override { return last_solved_ == Kind::direct; }

 private:
  enum class Kind { own_core, other_core, full_core, block_diagonal, ic0_core, ic0, direct };
  static const char* name_of(Kind kind);
  // Whether its accuracy has to be learnt.
  static bool is_incomplete(Kind kind) {
    return kind != Kind::own_core && kind != Kind::full_core && kind != Kind::direct;
  }
  static bool has_core(Kind kind) {
    return kind == Kind::own_core || kind == Kind::other_core || kind == Kind::full_core;
  }
  static double first_condition(Kind kind, const LinearSystem& system);
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
  struct Method {
    Kind kind;
    std::size_t other = 0;  // which of LinearSystem::other_cores
    Record record = {};
    std::unique_ptr<ConstrainedSolver> solver = nullptr;
    bool tried() const { return record.iterations >= 0.0; }
  };
  enum class Attempt { solved, given_up, failed };

  struct Solve;  // of one system
  // In the order of Kind, that of other_cores within it.
  static std::vector<Method> methods(std::size_t other_cores);
  Method& own_core() { return methods_.front(); }
  const Method& own_core() const { return methods_.front(); }
  Method& direct() { return methods_.back(); }
  const Method& method(Kind kind) const;
  // Room for so many other cores, at least.
  void know_cores(std::size_t other_cores);
  static bool available(const Method& method, const SystemSize& size);
  static double core_nonzeros(const Method& method, const SystemSize& size);
  static MethodWork work(const Method& method, const SystemSize& size);
  static double expected_work(const Method& method, const SystemSize& size);
  Method& choose(const SystemSize& size);
  // The rival to try, or `chosen` itself if none.
  Method& rival_of(Method& chosen, const Solve& solve);
  double least_iterations(const Method& method, const Solve& solve) const;
  // Iterations of a method until it has cost `limit`.
  static int budget(const Method& method, const SystemSize& size, double limit);
  double tolerance_for(const Method& method, const LinearSystem& system) const;
  Attempt attempt(Method& method, int most_iterations, Solve& solve);
  void learn(Method& method, const SolveSummary& summary, const CgCoefficients& record,
             double tolerance, Solve& solve);
  void note_trial(Method& method, bool won);
  ConstrainedSolver& solver(Method& method);
  Core full_core(const BlockCsr& a);

  std::vector<Method> methods_ = methods(0);
  Kind last_solved_ = Kind::own_core;  // what solved the last system that was solved
  double solves_ = 0.0;
  std::vector<double> guess_;
  std::vector<std::uint8_t> all_blocks_;  // a core's mask
};

}  // namespace taut
