#pragma once
// Time and iterations until a method has come as near to the answer as wanted: the only fair
// comparison (each method's own stop rule is in a norm of its own). Found in two runs: one watches
// the A-norm error after each iteration, the others are timed (medians, for each error) and stop
// after as many iterations. What a method does once per topology is not in the times; the analyses
// of CHOLMOD and PARDISO, which the paper does in every step, are, but for cholmod_reused_analysis.
// `auto` has some solves to look around, and its own stop rule.

#include <array>
#include <nlohmann/json.hpp>

#include "taut/solve/solver.h"

namespace taut::app {

inline constexpr std::array wanted_errors{1e-3, 1e-6};

struct TimeToError {
  int iterations = -1;  // 0 with a direct method; negative: not reached
  double ms = -1.0;     // set-up included
  bool reached() const { return iterations >= 0; }
};

struct EqualErrorResult {
  std::string solver;
  std::array<TimeToError, wanted_errors.size()> to;
  Status status;              // why an error was not reached
  SolveSummary summary;       // of the timed run
  double anorm_error = -1.0;  // at its end
  bool direct() const { return summary.iterations == 0; }
};

// `seconds`: after which the watched run is given up. `reference`: the answer, 3N doubles.
EqualErrorResult measure_equal_error(const LinearSystem& system, const std::string& solver,
                                     std::span<const double> reference, double seconds);

// The keys of a report's row: solver, iterations, setup_ms, ..., to_1e-3_ms, to_1e-6_iterations,
// ...
void put(nlohmann::ordered_json& row, const EqualErrorResult& result);
// "12.3 ms (4)": time and iterations, or "-".
std::string text_of(const TimeToError& time);

}  // namespace taut::app
