#include "bench/machine.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"
#include "taut/base/timer.h"

namespace taut::app {

namespace {

std::string processor_name() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

TAUT_MULTIVERSION double sum(const double* values, Index n) {
  double s = 0.0;
#pragma omp simd reduction(+ : s)
  for (Index i = 0; i < n; ++i) s += values[i];
  return s;
}

double read_bandwidth() {
  // 256 MB: eight times the largest cache of the machines this was written on.
  const Index n = 32 * 1024 * 1024;
  std::vector<double> values(static_cast<std::size_t>(n), 1.0);
  double best_ms = 1e30, total = 0.0;
  for (int round = 0; round < 7; ++round) {
    Timer timer;
    total += ordered_sum(n / 8192, [&](Index begin, Index end) { return sum(values.data() + Offset{begin} * 8192, (end - begin) * 8192); });
    best_ms = std::min(best_ms, timer.milliseconds());
  }
  return total > 0.0 ? 8.0 * n / best_ms / 1e6 : 0.0;
}

}  // namespace

MachineFacts machine_facts(bool measure) {
  MachineFacts facts;
  facts.processor = processor_name();
  facts.processors = static_cast<int>(std::thread::hardware_concurrency());
  facts.memory_GB = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE)) / 1e9;
  facts.instruction_set = instruction_set();
  facts.threads = thread_count();
  if (measure) facts.read_GB_per_s = read_bandwidth();
  return facts;
}

nlohmann::ordered_json to_json(const MachineFacts& facts) {
  nlohmann::ordered_json json{{"processor", facts.processor},
                              {"processors", facts.processors},
                              {"memory_GB", facts.memory_GB},
                              {"instruction_set", facts.instruction_set},
                              {"threads", facts.threads}};
  if (facts.read_GB_per_s > 0.0) json["read_GB_per_s"] = facts.read_GB_per_s;
  return json;
}

std::string to_line(const MachineFacts& facts) {
  return fmt::format("{}, {} processors, {:.0f} GB, {}; {} thread{}{}", facts.processor, facts.processors, facts.memory_GB, facts.instruction_set, facts.threads,
                     facts.threads == 1 ? "" : "s", facts.read_GB_per_s > 0.0 ? fmt::format(", reads {:.1f} GB/s", facts.read_GB_per_s) : "");
}

}  // namespace taut::app
