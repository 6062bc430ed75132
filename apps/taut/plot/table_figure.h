#pragma once
// The paper's tables as curves: time of a step relative to CHOLMOD's on the full matrix, ours
// joined by lines, the paper's as points.

#include <nlohmann/json.hpp>

#include "taut/plot/figure.h"

namespace taut::app {

// `rows`: of a report of table1 or table2.
Figure table_figure(const nlohmann::ordered_json& rows, const std::string& machine);

}  // namespace taut::app
