#include "bench/quiet.h"

#include <chrono>
#include <thread>
#include <vector>

#include "taut/base/parallel.h"

namespace taut::app {

void wait_for_quiet(const BlockCsr& a) {
  if (thread_count() == 1) return;
  std::this_thread::sleep_for(std::chrono::milliseconds(40));
  const std::vector<double> x(static_cast<std::size_t>(a.dofs()), 1.0);
  std::vector<double> y(x.size());
  multiply(a, x, y);
}

}  // namespace taut::app
