#pragma once
// Wall-clock stopwatch in milliseconds. Clocks are for reports only: no
// choice in Taut depends on one.

#include <chrono>

namespace taut {

class Timer {
 public:
  double milliseconds() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }
  // Time since construction or the last lap, and start the next lap.
  double lap() {
    const double elapsed = milliseconds();
    start_ = Clock::now();
    return elapsed;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace taut
