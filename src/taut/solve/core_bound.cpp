#include "taut/solve/core_bound.h"

#include <algorithm>
#include <cmath>

namespace taut {

int core_iteration_bound(double rho, double start_value, double tolerance) {
  if (start_value <= tolerance) return 0;
  const double root = std::sqrt(2.0 * (1.0 + rho));
  return static_cast<int>(std::max(1.0, std::ceil(0.5 * root * std::log(2.0 * root * start_value / tolerance))));
}

}  // namespace taut
