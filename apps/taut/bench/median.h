#pragma once
// Medians, of numbers and of the time that work takes.

#include <functional>
#include <vector>

namespace taut::app {

inline constexpr int repetitions = 9;

// 0 of none.
double median(std::vector<double> values);
// Of `repetitions` runs after a first one, one after the other: what fits in a cache stays there.
double median_ms(const std::function<void()>& work);

}  // namespace taut::app
