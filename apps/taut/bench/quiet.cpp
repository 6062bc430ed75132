#include "bench/quiet.h"

#include <vector>

#include "taut/base/parallel.h"
#include "taut/base/timer.h"

namespace taut::app {

void wait_for_quiet(const BlockCsr& a) {
  constexpr double milliseconds = 40.0;
  if (thread_count() == 1) return;
  const std::vector<double> x(static_cast<std::size_t>(a.dofs()), 1.0);
  std::vector<double> y(x.size());
  for (const Timer timer; timer.milliseconds() < milliseconds;) multiply(a, x, y);
}

}  // namespace taut::app
