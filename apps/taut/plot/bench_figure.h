#pragma once
// The figures of the benches and of `taut solve`, from what their --json holds: {"bench",
// "machine", "rows"}.

#include <filesystem>
#include <nlohmann/json.hpp>

#include "taut/plot/figure.h"

namespace taut::app {

// Throws InputError: not readable, no JSON, or no rows.
nlohmann::ordered_json read_report(const std::filesystem::path& file);

//   table1, table2   time of a step relative to CHOLMOD's on the full matrix, over k_stretch; the
//                    paper's beside it
//   flatness         heat maps: time to A-norm error 1e-3 and 1e-6 relative to CHOLMOD's; stiffness
//                    across; step, shear, bend down
//   scale            time to both errors and memory over the number of nodes
//   integrators      distance from the exact motion over time, a panel a scene and stiffness
//   solve            A-norm error over time, a point a method
//
// Throws InputError for a bench that has no figure.
Figure bench_figure(const nlohmann::ordered_json& report);

}  // namespace taut::app
