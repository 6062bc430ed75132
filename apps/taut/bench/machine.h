#pragma once
// The machine a figure was measured on.

#include <nlohmann/json.hpp>
#include <string>

namespace taut::app {

struct MachineFacts {
  std::string processor;
  int processors = 0;
  double memory_GB = 0.0;
  std::string instruction_set;  // what Taut's kernels resolved to
  double read_GB_per_s = 0.0;   // with `threads` threads; 0: not measured
  int threads = 0;
};

// Reads /proc; with `measure`, also the read bandwidth: the best of several sums over an array far
// larger than the caches.
MachineFacts machine_facts(bool measure);
// The rate, GB/s, at which all threads together read an array of `bytes` again and again: what fits
// into a cache comes from there. Median of several reads.
double read_rate(double bytes);
nlohmann::ordered_json to_json(const MachineFacts& facts);
std::string to_line(const MachineFacts& facts);

}  // namespace taut::app
