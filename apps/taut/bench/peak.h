#pragma once
// What this machine's arithmetic can do at best, measured: independent chains of fused
// multiply-adds in registers, on all of Taut's threads.

namespace taut::app {

struct PeakRates {
  double single_GF_per_s = 0.0, double_GF_per_s = 0.0;  // a multiply-add counts as two
};

PeakRates measure_peak_rates();

}  // namespace taut::app
