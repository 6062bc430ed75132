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

// Eight sums at once: one alone would wait for its additions, not for the memory.
TAUT_MULTIVERSION double sum(const double* values, Index n) {
  constexpr Index lanes = 32;
  double s[lanes] = {};
  for (Index i = 0; i + lanes <= n; i += lanes)
#pragma omp simd
    for (Index k = 0; k < lanes; ++k) s[k] += values[i + k];
  double total = 0.0;
  for (const double part : s) total += part;
  return total;
}

// 256 MB: eight times the largest cache of the machines this was written on.
constexpr double far_larger_than_caches = 256.0 * 1024 * 1024;

// ms of the best and of the median read of an array of `bytes`.
std::pair<double, double> time_reads(double bytes, int rounds) {
  constexpr Index chunk = 4096;
  const Index chunks = std::max<Index>(1, static_cast<Index>(bytes / (8.0 * chunk)));
  const std::vector<double> values(static_cast<std::size_t>(chunks) * chunk, 1.0);
  std::vector<double> times, sums(static_cast<std::size_t>(chunks));
  double total = 0.0;
  for (int round = 0; round < rounds; ++round) {
    Timer timer;
    parallel_for(chunks, 8, [&](Index begin, Index end) {
      for (Index c = begin; c < end; ++c) sums[c] = sum(values.data() + Offset{c} * chunk, chunk);
    });
    times.push_back(timer.milliseconds());
    total += sums[0];
  }
  std::ranges::sort(times);
  const double scale = total > 0.0 ? bytes / (8.0 * chunk * chunks) : 0.0;
  return {times.front() * scale, times[times.size() / 2] * scale};
}

}  // namespace

double read_rate(double bytes) { return bytes / time_reads(bytes, 9).second / 1e6; }

MachineFacts machine_facts(bool measure) {
  MachineFacts facts;
  facts.processor = processor_name();
  facts.processors = static_cast<int>(std::thread::hardware_concurrency());
  facts.memory_GB = static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                    static_cast<double>(sysconf(_SC_PAGE_SIZE)) / 1e9;
  facts.instruction_set = instruction_set();
  facts.threads = thread_count();
  if (measure)
    facts.read_GB_per_s =
        far_larger_than_caches / time_reads(far_larger_than_caches, 7).first / 1e6;
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
  return fmt::format(
      "{}, {} processors, {:.0f} GB, {}; {} thread{}{}", facts.processor, facts.processors,
      facts.memory_GB, facts.instruction_set, facts.threads, facts.threads == 1 ? "" : "s",
      facts.read_GB_per_s > 0.0 ? fmt::format(", reads {:.1f} GB/s", facts.read_GB_per_s) : "");
}

}  // namespace taut::app
