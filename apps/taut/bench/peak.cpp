#include "bench/peak.h"

#include <algorithm>
#include <vector>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"
#include "taut/base/timer.h"

namespace taut::app {

namespace {

constexpr int chains = 12;  // enough to hide the latency of two units, few enough for 16 registers
constexpr Index rounds = 1'000'000;
constexpr int runs = 60;  // a second or two: another program may take a core for a while

// One function per instruction set and type: `chains` vectors x = x a + b, kept in registers.
// Returns something that depends on all of them.
#define TAUT_FMA_LOOP(name, T, bytes, attributes)                                    \
  attributes double name(T a, T b) {                                                 \
    typedef T Vector __attribute__((vector_size(bytes)));                            \
    Vector x[chains];                                                                \
    for (int i = 0; i < chains; ++i) x[i] = Vector{} + T(i);                         \
    for (Index r = 0; r < rounds; ++r)                                               \
      _Pragma("GCC unroll 12") for (int i = 0; i < chains; ++i) x[i] = x[i] * a + b; \
    Vector sum{};                                                                    \
    for (int i = 0; i < chains; ++i) sum += x[i];                                    \
    return static_cast<double>(sum[0]);                                              \
  }

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
TAUT_FMA_LOOP(fma_v4_float, float, 64,
              __attribute__((target("arch=x86-64-v4"), optimize("fp-contract=fast"))))
TAUT_FMA_LOOP(fma_v4_double, double, 64,
              __attribute__((target("arch=x86-64-v4"), optimize("fp-contract=fast"))))
TAUT_FMA_LOOP(fma_v3_float, float, 32,
              __attribute__((target("arch=x86-64-v3"), optimize("fp-contract=fast"))))
TAUT_FMA_LOOP(fma_v3_double, double, 32,
              __attribute__((target("arch=x86-64-v3"), optimize("fp-contract=fast"))))
#endif
TAUT_FMA_LOOP(fma_plain_float, float, 16, )
TAUT_FMA_LOOP(fma_plain_double, double, 16, )

template <class T>
double best_rate(double (*loop)(T, T), int lanes) {
  const int threads = thread_count();
  double best = 1e30;
  std::vector<double> sink(static_cast<std::size_t>(threads));
  for (int run = 0; run < runs; ++run) {
    Timer timer;
    parallel_for(threads, 1, [&](Index begin, Index end) {
      for (Index t = begin; t < end; ++t) sink[t] += loop(T(0.999), T(1e-3));
    });
    best = std::min(best, timer.milliseconds());
  }
  return sink[0] != 0.0 ? 2.0 * chains * lanes * static_cast<double>(rounds) * threads / best / 1e6
                        : 0.0;
}

}  // namespace

PeakRates measure_peak_rates() {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  if (x86_64_level() >= 4) return {best_rate(fma_v4_float, 16), best_rate(fma_v4_double, 8)};
  if (x86_64_level() >= 3) return {best_rate(fma_v3_float, 8), best_rate(fma_v3_double, 4)};
#endif
  return {best_rate(fma_plain_float, 4), best_rate(fma_plain_double, 2)};
}

}  // namespace taut::app
