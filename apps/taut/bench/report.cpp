#include "bench/report.h"

#include "taut/step/integrator.h"

namespace taut::app {

nlohmann::ordered_json to_json(const ReportRow& row, int threads) {
  const Cell& c = row.cell;
  nlohmann::ordered_json json{{"scene", row.scene},
                              {"nodes", row.nodes},
                              {"k_stretch", row.k_stretch},
                              {"k_shear", row.k_shear},
                              {"k_bend", row.k_bend},
                              {"h", row.h},
                              {"integrator", name_of(c.method.integrator)},
                              {"solver", c.method.solver},
                              {"threads", threads},
                              {"iterations", c.iterations},
                              {"assemble_ms", c.assemble_ms},
                              {"setup_ms", c.setup_ms},
                              {"solve_ms", c.solve_ms},
                              {"total_ms", c.total_ms()}};
  if (c.ratio > 0.0)
    json["ratio_to_cholmod_full"] = c.ratio, json["step_ratio_to_cholmod_full"] = c.step_ratio;
  json["anorm_error"] = c.anorm_error;
  json["relative_residual"] = c.relative_residual;
  json["memory_MB"] = c.memory_MB;
  if (c.bound_iterations >= 0.0) json["bound_iterations"] = c.bound_iterations;
  json["spmv_ms"] = c.spmv_ms;
  json["precision"] = c.precision;
  json["fallbacks"] = c.fallbacks;
  json["steps"] = c.steps;
  json["failures"] = c.failures;
  if (c.method.solver == "pardiso_cgs") json["factorisations"] = c.factorisations;
  json["unknowns"] = c.unknowns;
  json["held_nodes"] = c.held_nodes;
  json["nonzeros"] = c.nonzeros;
  if (c.method.solver.starts_with("core_pcg")) json["reordering"] = c.method.reordering;
  if (c.equal_error_ms > 0.0) {
    json["equal_error"] = 1e-3;
    json["equal_error_ms"] = c.equal_error_ms;
    json["equal_error_iterations"] = c.equal_error_iterations;
    json["equal_error_ratio"] = c.equal_error_ratio;
  }
  return json;
}

}  // namespace taut::app
