#pragma once
// What a bench has measured, for people (text) and for programs (the JSON that docs/bench.md
// describes).

#include <nlohmann/json.hpp>
#include <string>

#include "bench/machine.h"
#include "bench/measure.h"

namespace taut::app {

// One cell with the settings it belongs to.
struct ReportRow {
  std::string scene;
  Index nodes = 0;
  double k_stretch = 0.0, k_shear = 0.0, k_bend = 0.0, h = 0.0;
  Cell cell;
};

nlohmann::ordered_json to_json(const ReportRow& row, int threads);

}  // namespace taut::app
