#include "plot/table_figure.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/paper_tables.h"

namespace taut::app {

namespace {

using Json = nlohmann::ordered_json;

// What a panel shows.
struct Group {
  std::string scene, integrator;
  int nodes;
  auto operator<=>(const Group&) const = default;
  std::string title() const {
    return fmt::format("{}, {} nodes, {}", scene, nodes,
                       integrator == "imex" ? "IMEX" : "semi-implicit Euler");
  }
};

Group group_of(const Json& row) {
  return {row.value("scene", ""), row.value("integrator", ""), row.value("nodes", 0)};
}

std::string method_of(const Json& row) {
  const std::string solver = row.value("solver", "");
  return row.value("reordering", "") == "matrix" ? solver + " (matrix reordered)" : solver;
}

double step_ms(const Json& row) {
  return row.value("assemble_ms", 0.0) + row.value("total_ms", 0.0);
}

// Table 1 has no direct method: there MPCG is what the others are compared with.
bool is_table1(const Group& group) { return group.scene != "ball"; }

// With assembly, as the paper counts; table 2: to CHOLMOD on the full (semi-implicit) matrix.
double base_ms(const Json& rows, const Group& group, double k) {
  const Group base{group.scene, "semi_implicit_euler", group.nodes};
  const std::string method = is_table1(group) ? "mpcg:diagonal" : "cholmod";
  for (const Json& row : rows)
    if (row.value("solver", "") == method && group_of(row) == base &&
        row.value("k_stretch", 0.0) == k)
      return step_ms(row);
  return NAN;
}

Curve& curve_named(Panel& panel, const std::string& name, CurveStyle style) {
  const auto found = std::ranges::find(panel.curves, name, &Curve::name);
  if (found != panel.curves.end()) return *found;
  return panel.curves.emplace_back(Curve{name, {}, style});
}

void add_paper(Panel& panel, const Group& group) {
  for (const char* method : {"mpcg", "upcg", "cholmod", "pardiso", "pardiso_cgs", "core_pcg"})
    for (const int k : {60, 600, 6000}) {
      const PaperRow* row = paper_row(group.scene, group.nodes, group.integrator, k, method);
      const PaperRow* base = paper_row(group.scene, group.nodes, "semi_implicit_euler", k,
                                       is_table1(group) ? "mpcg" : "cholmod");
      if (!row || !base || !row->seconds || !base->seconds) continue;
      curve_named(panel, fmt::format("paper: {}", method), CurveStyle::points)
          .points.push_back({double(k), *row->seconds / *base->seconds});
    }
}

}  // namespace

Figure table_figure(const Json& rows, const std::string& machine) {
  std::vector<Group> groups;
  for (const Json& row : rows)
    if (!std::ranges::count(groups, group_of(row))) groups.push_back(group_of(row));
  std::ranges::stable_sort(groups, [](const Group& a, const Group& b) {
    return std::pair(b.integrator, a.nodes) < std::pair(a.integrator, b.nodes);
  });
  const auto in_first_row =
      std::ranges::count(groups, groups.front().integrator, &Group::integrator);

  Figure figure;
  figure.title = std::string("Time of a step (assembly, set-up, solve) relative to ") +
                 (is_table1(groups.front()) ? "MPCG" : "CHOLMOD on the full matrix");
  figure.note =
      "Lines: measured here, all methods on the same states. Points alone: the paper's table. " +
      machine;
  figure.columns = static_cast<int>(std::min<std::ptrdiff_t>(3, in_first_row));
  figure.shared_legend = true;
  figure.panel_width = 300, figure.panel_height = 300;
  for (const Group& group : groups) {
    Panel panel;
    panel.title = group.title();
    panel.x = {"k_stretch, N/m", AxisScale::logarithmic, 40.0, 9000.0},
    panel.y = {"relative time", AxisScale::logarithmic};
    for (const Json& row : rows)
      if (group_of(row) == group) {
        const double k = row.value("k_stretch", 0.0);
        curve_named(panel, method_of(row), CurveStyle::line_and_points)
            .points.push_back({k, step_ms(row) / base_ms(rows, group, k)});
      }
    add_paper(panel, group);
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace taut::app
