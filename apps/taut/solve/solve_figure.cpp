#include "solve/solve_figure.h"

#include <fmt/format.h>

#include <algorithm>

namespace taut::app {

namespace {

constexpr double smallest_shown = 1e-17;  // an exact zero has no place on a logarithmic axis

double height_of(double error, double residual) {
  return std::max(smallest_shown, error < 0.0 ? residual : error);
}

// Every point of a long history would only make a large file.
std::vector<PlotPoint> thinned(const std::vector<PlotPoint>& points) {
  constexpr std::size_t most = 600;
  if (points.size() <= most) return points;
  std::vector<PlotPoint> some;
  for (std::size_t k = 0; k < most; ++k)
    some.push_back(points[k * (points.size() - 1) / (most - 1)]);
  return some;
}

Curve curve_of(const SolverRow& row, const std::vector<HistoryPoint>& histories) {
  Curve curve{row.summary.solver, {}, CurveStyle::line_and_points};
  for (const HistoryPoint& point : histories)
    if (point.solver == row.summary.solver)
      curve.points.push_back(
          {std::max(1e-3, point.time_ms), height_of(point.anorm_error, point.residual)});
  curve.points = thinned(curve.points);
  if (curve.points.empty()) {
    curve.style = CurveStyle::points;
    // A method that failed has no answer to show, only its name in the legend.
    if (row.summary.status.ok())
      curve.points.push_back(
          {row.summary.total_ms(), height_of(row.anorm_error, row.summary.relative_residual)});
  }
  if (!row.summary.status.ok())
    curve.name += fmt::format(" ({})", name_of(row.summary.status.outcome));
  return curve;
}

}  // namespace

Figure solve_figure(const std::vector<SolverRow>& rows, const std::vector<HistoryPoint>& histories,
                    const std::string& title) {
  const bool has_error =
      std::ranges::any_of(rows, [](const SolverRow& row) { return row.anorm_error >= 0.0; });
  Figure figure;
  figure.title = title;
  figure.note =
      "Time with set-up. A direct method is one point: it has nothing before it has everything.";
  Panel panel;
  panel.x = {"time, ms", AxisScale::logarithmic};
  panel.y = {
      has_error ? "A-norm error against a refined direct solution" : "true relative residual",
      AxisScale::logarithmic};
  for (const SolverRow& row : rows) panel.curves.push_back(curve_of(row, histories));
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace taut::app
