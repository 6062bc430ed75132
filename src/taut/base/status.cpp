#include "taut/base/status.h"

namespace taut {

const char* name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::converged:
      return "converged";
    case Outcome::max_iterations:
      return "max_iterations";
    case Outcome::not_positive_definite:
      return "not_positive_definite";
    case Outcome::not_finite:
      return "not_finite";
    case Outcome::breakdown:
      return "breakdown";
    case Outcome::out_of_memory:
      return "out_of_memory";
  }
  return "unknown";
}

}  // namespace taut
