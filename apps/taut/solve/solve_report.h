#pragma once
// What `taut solve` prints and writes.

#include <nlohmann/json.hpp>

#include "solve/measure_solvers.h"
#include "taut/solve/core_spectrum.h"

namespace taut::app {

// The table that people read.
std::string solve_table(const std::vector<SolverRow>& rows);
// {"bench": "solve", "machine": ..., "rows": [...]}; `facts`: keys that all rows share (scene,
// nodes, h, ...).
nlohmann::ordered_json solve_json(const std::vector<SolverRow>& rows,
                                  const nlohmann::ordered_json& facts);
// The core's measured eigenvalues and iterations beside their bounds (solve/core_spectrum.h).
std::string spectrum_text(const CoreSpectrum& spectrum, double tolerance);
nlohmann::ordered_json to_json(const CoreSpectrum& spectrum);
// What meta.json of a dump says about the system: scene, nodes, k_stretch, k_shear, k_bend, h,
// integrator. {} when it says nothing. files_of_dump has seen that it is one.
nlohmann::ordered_json dump_facts(const std::string& meta_file);
// solver,iteration,stop_value,residual,anorm_error,time_ms
std::string history_csv(const std::vector<HistoryPoint>& points);

}  // namespace taut::app
