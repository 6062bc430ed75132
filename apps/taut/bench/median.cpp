#include "bench/median.h"

#include <algorithm>

#include "taut/base/timer.h"

namespace taut::app {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double median_ms(const std::function<void()>& work) {
  work();
  std::vector<double> times;
  for (int k = 0; k < repetitions; ++k) {
    Timer timer;
    work();
    times.push_back(timer.milliseconds());
  }
  return median(times);
}

}  // namespace taut::app
