#include "solve/solve_report.h"

#include <fmt/format.h>

#include "bench/machine.h"
#include "bench/table.h"
#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/base/parallel.h"

namespace taut::app {

namespace {

using Json = nlohmann::ordered_json;

std::string error_text(double error) { return error < 0.0 ? "" : fmt::format("{:.2e}", error); }

std::string ms_text(double ms) {
  return ms < 1.0 ? fmt::format("{:.4f}", ms) : fmt::format("{:.2f}", ms);
}

// JSON has no NaN and no infinity.
void put_finite(Json& json, const char* key, double value) {
  if (std::isfinite(value)) json[key] = value;
}

Json row_json(const SolverRow& row, const Json& facts, double reference_ms) {
  const SolveSummary& s = row.summary;
  Json json = facts;
  json["solver"] = s.solver;
  json["threads"] = thread_count();
  json["status"] = name_of(s.status.outcome);
  if (!s.status.message.empty()) json["message"] = s.status.message;
  if (!s.remark.empty()) json["remark"] = s.remark;
  if (s.method != s.solver) json["method"] = s.method;
  json["iterations"] = s.iterations;
  if (s.bound_iterations >= 0) json["bound_iterations"] = s.bound_iterations;
  json["setup_ms"] = setup_ms(s);
  json["solve_ms"] = s.solve_ms;
  json["solves"] = row.solves;
  json["total_ms"] = s.total_ms();
  if (reference_ms > 0.0) json["ratio_to_cholmod_full"] = s.total_ms() / reference_ms;
  if (row.anorm_error >= 0.0) put_finite(json, "anorm_error", row.anorm_error);
  put_finite(json, "relative_residual", s.relative_residual);
  json["memory_MB"] = s.memory_bytes / 1e6;
  json["precision"] = s.precision;
  if (s.replaced) json["replaced"] = true;
  if (s.fallbacks > 0) json["fallbacks"] = s.fallbacks;
  return json;
}

}  // namespace

std::string solve_table(const std::vector<SolverRow>& rows) {
  TextTable table({"solver", "status", "iterations", "setup ms", "solve ms", "solves", "memory MB",
                   "residual", "A-norm error"});
  for (const auto& [s, error, solves, options] : rows)
    table.add({s.method == s.solver ? s.solver : s.solver + " (" + s.method + ")",
               name_of(s.status.outcome), std::to_string(s.iterations), ms_text(setup_ms(s)),
               ms_text(s.solve_ms), std::to_string(solves),
               fmt::format("{:.2f}", s.memory_bytes / 1e6),
               fmt::format("{:.2e}", s.relative_residual), error_text(error)});
  return table.text();
}

std::string spectrum_text(const CoreSpectrum& spectrum, double tolerance) {
  const double condition = spectrum.smallest > 0.0 ? spectrum.largest / spectrum.smallest : 0.0;
  std::string text = fmt::format("core: λ(P⁻¹A) from {:.4g} to {:.4g}, condition {:.4g}",
                                 spectrum.smallest, spectrum.largest, condition);
  if (spectrum.rho >= 0.0)
    text += fmt::format("; bound: from {:.4g} to 2, condition {:.4g} (ρ = {:.4g})",
                        1.0 / (1.0 + spectrum.rho), spectrum.bound, spectrum.rho);
  text += fmt::format("; iterations to {:g}: {}", tolerance, spectrum.iterations);
  if (spectrum.rho >= 0.0) text += fmt::format(", bound {}", spectrum.bound_iterations);
  return text + "\n";
}

Json to_json(const CoreSpectrum& spectrum) {
  Json json{{"smallest", spectrum.smallest},
            {"largest", spectrum.largest},
            {"iterations", spectrum.iterations}};
  if (spectrum.rho >= 0.0)
    json["rho"] = spectrum.rho, json["bound"] = spectrum.bound,
    json["bound_iterations"] = spectrum.bound_iterations;
  return json;
}

Json solve_json(const std::vector<SolverRow>& rows, const Json& facts) {
  double reference_ms = 0.0;
  for (const SolverRow& row : rows)
    if (row.summary.solver == "cholmod" && row.summary.status.ok())
      reference_ms = row.summary.total_ms();
  Json json{
      {"bench", "solve"}, {"machine", to_json(machine_facts(false))}, {"rows", Json::array()}};
  for (const SolverRow& row : rows) json["rows"].push_back(row_json(row, facts, reference_ms));
  return json;
}

Json dump_facts(const std::string& meta_file) {
  const Json meta = Json::parse(read_file(meta_file));
  Json facts = Json::object();
  if (meta.contains("title")) facts["scene"] = meta["title"];
  if (meta.contains("nodes")) facts["nodes"] = meta["nodes"];
  // With several cloths there is no one stiffness.
  if (meta.contains("cloths") && meta["cloths"].is_array() && meta["cloths"].size() == 1)
    for (const char* key : {"k_stretch", "k_shear", "k_bend"})
      if (meta["cloths"][0].contains(key)) facts[key] = meta["cloths"][0][key];
  for (const char* key : {"h", "integrator"})
    if (meta.contains(key)) facts[key] = meta[key];
  return facts;
}

std::string history_csv(const std::vector<HistoryPoint>& points) {
  std::string text = "solver,iteration,stop_value,residual,anorm_error,time_ms\n";
  for (const HistoryPoint& p : points)
    fmt::format_to(std::back_inserter(text), "{},{},{:.9g},{:.9g},{},{:.6g}\n", p.solver,
                   p.iteration, p.stop_value, p.residual,
                   p.anorm_error < 0.0 ? "" : fmt::format("{:.9g}", p.anorm_error), p.time_ms);
  return text;
}

}  // namespace taut::app
