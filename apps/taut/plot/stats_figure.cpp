#include "plot/stats_figure.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "taut/base/error.h"
#include "taut/base/file.h"

namespace taut::app {

namespace {

std::vector<std::string_view> fields_of(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> fields;
  for (std::size_t at = 0;;) {
    const std::size_t comma = line.find(',', at);
    fields.push_back(line.substr(at, comma - at));
    if (comma == std::string_view::npos) return fields;
    at = comma + 1;
  }
}

double number(std::string_view text) {
  double value = NAN;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failure == std::errc() && end == text.data() + text.size() ? value : NAN;
}

// Whole lines only.
std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string_view::npos; at = end + 1)
    lines.push_back(text.substr(at, end - at));
  return lines;
}

class StatsPanels {
 public:
  explicit StatsPanels(const Columns& columns) : columns_(columns) {}

  struct Wanted {
    const char* column;
    const char* name;
  };
  void add(const char* label, AxisScale scale, const std::vector<Wanted>& wanted) {
    Panel panel;
    panel.y = {label, scale};
    if (scale == AxisScale::linear) panel.y.low = 0.0;
    for (const auto& [column, name] : wanted) {
      Curve curve = curve_of(column, name);
      if (!curve.points.empty()) panel.curves.push_back(std::move(curve));
    }
    if (!panel.curves.empty()) panels_.push_back(std::move(panel));
  }

  std::vector<Panel> take() {
    if (!panels_.empty()) panels_.back().x.label = "simulated time, s";
    for (Panel& panel : panels_) panel.x.low = first_time(), panel.x.high = last_time();
    return std::move(panels_);
  }

 private:
  // A panel is no more than a few hundred pixels wide.
  static constexpr std::size_t most_points = 4000;

  Curve curve_of(const char* column, const char* name) const {
    Curve curve{name, {}, CurveStyle::line};
    const auto values = columns_.find(column), times = columns_.find("time");
    if (values == columns_.end() || times == columns_.end()) return curve;
    const std::size_t rows = times->second.size(),
                      stride = std::max<std::size_t>(1, rows / most_points);
    bool any = false;
    for (std::size_t k = 0; k < rows; k += stride) {
      curve.points.push_back({times->second[k], values->second[k]});
      any = any || std::isfinite(values->second[k]);
    }
    if (!any) curve.points.clear();
    return curve;
  }
  double first_time() const { return 0.0; }
  double last_time() const {
    double last = 0.0;
    for (const double time : columns_.at("time"))
      if (std::isfinite(time)) last = std::max(last, time);
    return last > 0.0 ? last : NAN;
  }

  const Columns& columns_;
  std::vector<Panel> panels_;
};

}  // namespace

Columns read_columns(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  const auto lines = lines_of(text);
  if (lines.empty())
    throw InputError({file.string()}, "holds no whole line yet; the run may just have begun");
  const auto names = fields_of(lines[0]);
  std::vector<std::vector<double>> values(names.size());
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const auto fields = fields_of(lines[k]);
    if (fields.size() != names.size())
      throw InputError({file.string(), static_cast<int>(k) + 1},
                       std::to_string(fields.size()) + " fields, but the header names " +
                           std::to_string(names.size()) + " columns");
    for (std::size_t c = 0; c < names.size(); ++c) values[c].push_back(number(fields[c]));
  }
  Columns columns;
  for (std::size_t c = 0; c < names.size(); ++c)
    columns[std::string(names[c])] = std::move(values[c]);
  if (!columns.contains("time"))
    throw InputError({file.string(), 1},
                     "there is no column 'time'; a stats.csv of `taut run` was expected");
  return columns;
}

Figure stats_figure(const Columns& columns, const std::string& title, const std::string& note) {
  Figure figure;
  figure.title = title;
  figure.note = note;
  StatsPanels panels(columns);
  panels.add("iterations", AxisScale::linear,
             {{"iterations", "iterations"}, {"bound_iterations", "bound"}});
  panels.add("ms a step", AxisScale::logarithmic,
             {{"step_ms", "whole step"},
              {"assemble_ms", "assembly"},
              {"order_ms", "ordering"},
              {"factor_ms", "factorisation"},
              {"solve_ms", "solve"},
              {"contact_ms", "contact"}});
  panels.add("energy, J", AxisScale::linear, {{"kinetic_J", "kinetic"}, {"elastic_J", "elastic"}});
  panels.add("max stretch", AxisScale::linear, {{"max_stretch", "largest L/L0 - 1"}});
  panels.add("contacts", AxisScale::linear,
             {{"contacts", "contacts"}, {"constraints", "constrained dofs"}});
  figure.panels = panels.take();
  return figure;
}

}  // namespace taut::app
