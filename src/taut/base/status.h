#pragma once
// How a numerical task ended. Returned, never thrown: the caller reacts (smaller step, stronger
// method) and says so.

#include <string>

namespace taut {

enum class Outcome {
  converged,              // did what was asked
  max_iterations,         // gave up at the iteration limit; the best answer so far is returned
  not_positive_definite,  // a pivot <= 0, or a search direction of non-positive curvature
  not_finite,             // NaN or infinity appeared
  breakdown,              // the method cannot go on (BiCGSTAB's inner products vanish)
  out_of_memory,          // a factorisation did not fit
};

// The outcome's name as it stands in reports: "converged", "max_iterations", ...
const char* name_of(Outcome outcome);

struct Status {
  Outcome outcome = Outcome::converged;
  std::string message;  // empty when converged; else what was found where, with numbers
  bool ok() const { return outcome == Outcome::converged; }
};

}  // namespace taut
