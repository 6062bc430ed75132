#include "taut/plot/plot_layout.h"

#include <algorithm>

namespace taut {

namespace {

constexpr double letter = 7.6, title_height = 44, panel_title_height = 26, note_height = 26,
                 axis_height = 54, edge = 16;

// Letters, roughly: continuation bytes of UTF-8 are none.
double text_width(const std::string& text) {
  return letter * static_cast<double>(std::ranges::count_if(
                      text, [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

double widest(const std::vector<std::string>& texts) {
  double width = 0;
  for (const std::string& text : texts) width = std::max(width, text_width(text));
  return width;
}

double legend_width(const Figure& figure) {
  double width = 0;
  for (const Panel& panel : figure.panels)
    for (const Curve& curve : panel.curves) width = std::max(width, text_width(curve.name));
  return width > 0 ? width + 64 : 0;
}

bool has_heat_map(const Figure& figure) {
  return std::ranges::any_of(figure.panels,
                             [](const Panel& panel) { return !panel.heat_map.empty(); });
}

// Room left of a frame for the numbers and the label of its y axis. Heat maps beside one another
// share the labels of their rows.
double left_room(const Figure& figure, int column) {
  double width = 76;
  for (const Panel& panel : figure.panels)
    for (const HeatMap& map : panel.heat_map)
      width = column > 0 ? 0 : std::max(width, widest(map.rows));
  return width + 24;
}

// Panels over one another, of which only the lowest has its x axis written out; so
// have grids of heat maps.
bool is_stack(const Figure& figure) {
  return figure.columns <= 1 &&
         std::none_of(figure.panels.begin(), figure.panels.end() - (figure.panels.empty() ? 0 : 1),
                      [](const Panel& panel) { return !panel.x.label.empty(); });
}

int chosen(int wanted, double otherwise) {
  return wanted > 0 ? wanted : static_cast<int>(otherwise);
}

int panel_width(const Figure& figure) {
  double width = figure.columns == 1 ? 760 : figure.columns == 2 ? 400 : 290;
  for (const Panel& panel : figure.panels)
    for (const HeatMap& map : panel.heat_map)
      width =
          std::max(figure.columns > 1 ? 0.0 : width,
                   (figure.columns > 1 ? 50.0 : 62.0) * static_cast<double>(map.columns.size()));
  for (const Panel& panel : figure.panels) width = std::max(width, 1.15 * text_width(panel.title));
  return chosen(figure.panel_width, width);
}

int panel_height(const Figure& figure) {
  double height = figure.panels.size() == 1 ? 460 : figure.columns == 1 ? 150 : 230;
  std::size_t legend = 0;
  for (const Panel& panel : figure.panels) {
    for (const HeatMap& map : panel.heat_map)
      height = std::max(height, 24.0 * static_cast<double>(map.rows.size()));
    legend = std::max(legend, panel.curves.size());
  }
  height = std::max(height, 19.0 * static_cast<double>(
                                       figure.shared_legend ? shared_legend_rows(figure) : legend));
  return chosen(figure.panel_height, height);
}

}  // namespace

std::vector<const Curve*> shared_legend(const Figure& figure) {
  std::vector<const Curve*> legend;
  for (const Panel& panel : figure.panels)
    for (const Curve& curve : panel.curves)
      if (!curve.name.empty() &&
          std::ranges::none_of(legend, [&](const Curve* c) { return c->name == curve.name; }))
        legend.push_back(&curve);
  return legend;
}

std::size_t shared_legend_rows(const Figure& figure) {
  const std::size_t columns = static_cast<std::size_t>(std::max(1, figure.columns));
  const std::size_t rows = std::max<std::size_t>(1, (figure.panels.size() + columns - 1) / columns);
  return (shared_legend(figure).size() + rows - 1) / rows;
}

PlotLayout lay_out(const Figure& figure) {
  const int columns = std::max(1, figure.columns), panels = static_cast<int>(figure.panels.size());
  const int rows = (panels + columns - 1) / columns;
  const double width = panel_width(figure), height = panel_height(figure),
               legend = legend_width(figure);
  const bool heat = has_heat_map(figure),
             titled = std::ranges::any_of(figure.panels,
                                          [](const Panel& panel) { return !panel.title.empty(); });
  const double above = titled ? panel_title_height : 8,
               own_legend = figure.shared_legend ? 0 : legend, colours = heat ? 110 : 0;
  const double below = heat || is_stack(figure) ? 10 : axis_height;

  PlotLayout layout;
  std::vector<double> left;
  double across = 0;
  for (int c = 0; c < columns; ++c) {
    left.push_back(across + left_room(figure, c));
    across = left.back() + width + own_legend;
  }
  const double head = figure.title.empty() ? edge : title_height,
               foot = (figure.note.empty() ? 4 : note_height) + axis_height - below;
  const double texts =
      std::max(1.5 * text_width(figure.title), 0.82 * text_width(figure.note)) + 2 * edge;
  layout.width = static_cast<int>(
      std::max(texts, across + (figure.shared_legend ? legend : 0) + colours + edge));
  layout.height = static_cast<int>(head + rows * (above + height + below) + foot);
  for (int p = 0; p < panels; ++p) {
    const double x = left[static_cast<std::size_t>(p % columns)],
                 top = layout.height - head - p / columns * (above + height + below) - above;
    layout.axes.push_back({x, top - height, x + width, top});
  }
  if (heat)
    layout.colour_bar = {across + 14, layout.axes.back().bottom, across + 32,
                         layout.axes.front().top};
  return layout;
}

}  // namespace taut
