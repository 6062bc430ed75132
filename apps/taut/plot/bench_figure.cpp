#include "plot/bench_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "plot/table_figure.h"
#include "taut/base/error.h"
#include "taut/base/file.h"

namespace taut::app {

namespace {

using Json = nlohmann::ordered_json;

double number(const Json& row, const char* key) {
  return row.contains(key) && row[key].is_number() ? row[key].get<double>() : NAN;
}
std::string text(const Json& row, const char* key) {
  return row.contains(key) && row[key].is_string() ? row[key].get<std::string>() : "";
}

std::vector<std::string> solvers_of(const Json& rows) {
  std::vector<std::string> solvers;
  for (const Json& row : rows)
    if (const std::string solver = text(row, "solver"); !std::ranges::count(solvers, solver))
      solvers.push_back(solver);
  return solvers;
}

std::vector<double> values_of(const Json& rows, const char* key) {
  std::set<double> values;
  for (const Json& row : rows)
    if (const double value = number(row, key); std::isfinite(value)) values.insert(value);
  return {values.begin(), values.end()};
}

std::string short_number(double value) {
  return value >= 1e4    ? fmt::format("{:.0e}", value)
         : value >= 99.5 ? fmt::format("{:.0f}", value)
                         : fmt::format("{:.2g}", value);
}

std::string machine_note(const Json& report) {
  const Json machine = report.value("machine", Json::object());
  const int threads = machine.value("threads", 0);
  return fmt::format("{}, {} thread{}", machine.value("processor", std::string("machine unknown")),
                     threads, threads == 1 ? "" : "s");
}

// One line of the heat maps.
struct Setting {
  double h, k_shear, k_bend;
  auto operator<=>(const Setting&) const = default;
  std::string label() const {
    return fmt::format("{:g} ms   {:g} / {:g}", 1e3 * h, k_shear, k_bend);
  }
};

class FlatnessFigure {
 public:
  explicit FlatnessFigure(const Json& rows)
      : rows_(rows), k_stretch_(values_of(rows, "k_stretch")) {
    std::set<Setting> settings;
    for (const Json& row : rows) settings.insert(setting_of(row));
    settings_.assign(settings.begin(), settings.end());
  }

  Figure figure(const std::string& machine) const {
    Figure figure;
    figure.title = fmt::format(
        "Time to A-norm error 1e-3 and 1e-6, {:.0f} nodes: ms, coloured by the ratio to CHOLMOD on "
        "the full matrix",
        number(rows_.front(), "nodes"));
    figure.note =
        "Down: step h, k_shear / k_bend. Across: k_stretch, N/m. Grey: not reached. " + machine;
    figure.columns = 4;
    for (const std::string& solver : solvers_of(rows_))
      for (const char* error : {"1e-3", "1e-6"}) figure.panels.push_back(panel(solver, error));
    return figure;
  }

 private:
  static Setting setting_of(const Json& row) {
    return {number(row, "h"), number(row, "k_shear"), number(row, "k_bend")};
  }

  const Json* find(const std::string& solver, const Setting& setting, double k) const {
    const auto found = std::ranges::find_if(rows_, [&](const Json& row) {
      return text(row, "solver") == solver && setting_of(row) == setting &&
             number(row, "k_stretch") == k;
    });
    return found == rows_.end() ? nullptr : &*found;
  }

  Panel panel(const std::string& solver, const std::string& error) const {
    HeatMap map;
    map.scale = AxisScale::logarithmic, map.diverging = true, map.low = 0.05, map.high = 20.0;
    map.label = "time / time of CHOLMOD on the full matrix";
    for (const double k : k_stretch_) map.columns.push_back(fmt::format("{:g}", k));
    const std::string key = "to_" + error + "_ms";
    for (const Setting& setting : settings_) {
      map.rows.push_back(setting.label());
      for (const double k : k_stretch_) {
        const Json *row = find(solver, setting, k), *full = find("cholmod", setting, k);
        const double ms = row ? number(*row, key.c_str()) : NAN,
                     full_ms = full ? number(*full, key.c_str()) : NAN;
        map.values.push_back(ms / full_ms);
        map.texts.push_back(std::isfinite(ms) ? short_number(ms) : "");
      }
    }
    Panel panel;
    panel.title = solver + " to " + error;
    panel.heat_map.push_back(std::move(map));
    return panel;
  }

  const Json& rows_;
  std::vector<double> k_stretch_;
  std::vector<Setting> settings_;
};

Figure scale_figure(const Json& rows, const std::string& machine) {
  Figure figure;
  figure.title = "Time and memory over the number of nodes";
  figure.note = "Set-up included. " + machine;
  figure.columns = 3, figure.shared_legend = true, figure.panel_width = 330,
  figure.panel_height = 400;
  for (const auto& [key, label] : {std::pair("to_1e-3_ms", "ms to A-norm error 1e-3"),
                                   {"to_1e-6_ms", "ms to A-norm error 1e-6"},
                                   {"memory_MB", "memory, MB"}}) {
    Panel panel;
    panel.x = {"nodes", AxisScale::logarithmic}, panel.y = {label, AxisScale::logarithmic};
    for (const std::string& solver : solvers_of(rows)) {
      Curve curve{solver, {}, CurveStyle::line_and_points};
      for (const Json& row : rows)
        if (text(row, "solver") == solver)
          curve.points.push_back({number(row, "nodes"), number(row, key)});
      panel.curves.push_back(std::move(curve));
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure integrators_figure(const Json& rows, const std::string& machine) {
  Figure figure;
  figure.title = fmt::format("Integrators: distance from the exact motion against time, {} nodes",
                             rows.front().value("nodes", 0));
  figure.note =
      "A point a step length, joined from the longest to the shortest. What blew up is not "
      "there. " +
      machine;
  figure.columns = 2, figure.shared_legend = true, figure.panel_width = 430,
  figure.panel_height = 330;
  std::vector<std::pair<std::string, double>> scenes;
  for (const Json& row : rows)
    if (const std::pair scene(text(row, "scene"), number(row, "k_stretch"));
        !std::ranges::count(scenes, scene))
      scenes.push_back(scene);
  for (const auto& [scene, k] : scenes) {
    Panel panel;
    panel.title = fmt::format("{}, k_stretch {:g} N/m", scene, k);
    panel.x = {"time of the run, s", AxisScale::logarithmic},
    panel.y = {"rms distance, mm", AxisScale::logarithmic};
    for (const Json& row : rows) {
      if (text(row, "scene") != scene || number(row, "k_stretch") != k || !row.contains("rms_m"))
        continue;
      const std::string name = text(row, "integrator");
      auto curve = std::ranges::find(panel.curves, name, &Curve::name);
      if (curve == panel.curves.end())
        curve = panel.curves.insert(curve, Curve{name, {}, CurveStyle::line_and_points});
      curve->points.push_back({number(row, "seconds"), 1e3 * number(row, "rms_m")});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure contact_figure(const Json& rows, const std::string& machine) {
  Figure figure;
  figure.title = "Contact: ms a step by phase";
  figure.note = machine;
  figure.columns = 2, figure.shared_legend = true, figure.panel_width = 430,
  figure.panel_height = 330;
  std::vector<std::string> scenes;
  for (const Json& row : rows)
    if (const std::string scene = text(row, "scene"); !std::ranges::count(scenes, scene))
      scenes.push_back(scene);
  for (const std::string& scene : scenes) {
    Panel panel;
    panel.title = scene;
    panel.x = {"time, s"}, panel.y = {"ms a step"};
    for (const auto& [key, name] : {std::pair("near_ms", "near pairs"),
                                    {"impulse_ms", "impulses"},
                                    {"detect_ms", "continuous detection"},
                                    {"zone_ms", "rigid zones"},
                                    {"contact_ms", "all contact"},
                                    {"check_ms", "check for intersections"}}) {
      Curve curve{name, {}, CurveStyle::line};
      for (const Json& row : rows)
        if (text(row, "scene") == scene)
          curve.points.push_back({number(row, "time"), number(row, key)});
      panel.curves.push_back(std::move(curve));
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure solve_report_figure(const Json& rows, const std::string& machine) {
  const bool has_error =
      std::ranges::any_of(rows, [](const Json& row) { return row.contains("anorm_error"); });
  Figure figure;
  figure.title = fmt::format("{}: {} unknowns", text(rows.front(), "scene"),
                             rows.front().value("unknowns", 0));
  figure.note = "Time with set-up, at the end of each solve. " + machine;
  Panel panel;
  panel.x = {"time, ms", AxisScale::logarithmic};
  panel.y = {has_error ? "A-norm error" : "true relative residual", AxisScale::logarithmic};
  for (const Json& row : rows) {
    const std::string status = text(row, "status");
    const double error = number(row, has_error ? "anorm_error" : "relative_residual");
    panel.curves.push_back(
        {text(row, "solver") + (status == "converged" ? "" : " (" + status + ")"),
         {{number(row, "total_ms"), std::max(1e-17, error)}},
         CurveStyle::points});
  }
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace

Json read_report(const std::filesystem::path& file) {
  const Json report = Json::parse(read_file(file), nullptr, false);
  if (!report.is_object() || !report.contains("rows") || !report["rows"].is_array() ||
      report["rows"].empty())
    throw InputError({file.string()},
                     "holds no rows to draw; a folder of `taut run`, or what --json of a bench or "
                     "of `taut solve` has written, was expected");
  for (const Json& row : report["rows"])
    if (!row.is_object() || text(row, "solver").empty())
      throw InputError(
          {file.string()},
          "holds a row without \"solver\": it is not a report of a bench or of `taut solve`");
  return report;
}

Figure bench_figure(const Json& report) {
  const std::string bench = report.value("bench", std::string()), machine = machine_note(report);
  const Json& rows = report.at("rows");
  if (bench == "flatness") return FlatnessFigure(rows).figure(machine);
  if (bench == "scale") return scale_figure(rows, machine);
  if (bench == "integrators") return integrators_figure(rows, machine);
  if (bench == "contact") return contact_figure(rows, machine);
  if (bench == "solve") return solve_report_figure(rows, machine);
  if (bench == "table1" || bench == "table2") return table_figure(rows, machine);
  throw InputError(
      bench.empty()
          ? "the report does not say of which bench it is (\"bench\"), so it cannot be drawn"
          : fmt::format("there is no figure for the bench '{}'; there are some for table1, table2, "
                        "flatness, scale, integrators, contact and solve",
                        bench));
}

}  // namespace taut::app
