#include "taut/plot/gnuplot_script.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "taut/plot/heat_colours.h"
#include "taut/plot/plot_layout.h"

namespace taut {

namespace {

// Okabe & Ito without their yellow, which vanishes on white.
constexpr std::array colours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                             "#E69F00", "#56B4E9", "#000000"};
constexpr std::array dashes{"solid", "(9,4)", "(2,3)", "(9,3,2,3)"};
constexpr std::array marks{7, 5, 9, 11, 13, 6, 4, 8, 10, 12, 14};

bool drawable(double value, const Axis& axis) {
  return std::isfinite(value) && (axis.scale == AxisScale::linear || value > 0.0);
}

// A line of the file a point; an empty line where the curve is to break.
// Empty text: nothing to draw.
std::string curve_data(const Curve& curve, const Panel& panel) {
  std::string text;
  bool drawn = false;
  for (const PlotPoint& point : curve.points) {
    const bool here = drawable(point.x, panel.x) && drawable(point.y, panel.y);
    drawn = drawn || here;
    text += here ? fmt::format("{:.12g} {:.12g}\n", point.x, point.y) : "\n";
  }
  return drawn ? text : "";
}

class ScriptWriter {
 public:
  ScriptWriter(const Figure& figure, bool svg) : figure_(figure), layout_(lay_out(figure)) {
    job_.output = svg ? "figure.svg" : "figure.png";
    const char* terminal = svg ? "svg background '#ffffff' font 'sans-serif,13'"
                               : "pngcairo background '#ffffff' font 'sans,10.5'";
    line("set terminal {} size {},{} noenhanced", terminal, layout_.width, layout_.height);
    line("set encoding utf8\nset output '{}'", job_.output);
    line("set multiplot");
    common_settings();
  }

  GnuplotJob write() {
    colour_range_ = heat_range(figure_);
    for (std::size_t p = 0; p < figure_.panels.size(); ++p) {
      const Panel& panel = figure_.panels[p];
      place(p);
      axis("x", panel.x, !is_stacked_above(p)), axis("y", panel.y, true);
      panel.heat_map.empty() ? curves(p) : heat_map(p);
    }
    line("unset multiplot\nset output");
    return std::move(job_);
  }

 private:
  template <class... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(job_.script), format, std::forward<Args>(args)...);
    job_.script += '\n';
  }

  void common_settings() {
    line("set border 3 lc rgb '#555555'\nset tics nomirror out scale 0.6 tc rgb '#333333'");
    line("set grid lc rgb '#e3e3e3' lt 1 lw 1\nset grid back");
    if (!figure_.title.empty()) label(figure_.title, 16, layout_.height - 24, "font ',15'");
    if (!figure_.note.empty()) label(figure_.note, 16, 14, "font ',9.5' tc rgb '#555555'");
  }

  // A label that all panels show where the last stood is drawn with the first only.
  void label(const std::string& text, double x, double y, const char* looks) {
    line("set label {} {} at screen {:.5f},{:.5f} left {}", ++labels_, gnuplot_string(text),
         x / layout_.width, y / layout_.height, looks);
  }

  void place(std::size_t p) {
    if (p == 1)
      for (; labels_ > 0; --labels_) line("unset label {}", labels_);
    const PlotBox& box = layout_.axes[p];
    line("set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}", box.left / layout_.width,
         box.right / layout_.width);
    line("set bmargin at screen {:.5f}\nset tmargin at screen {:.5f}", box.bottom / layout_.height,
         box.top / layout_.height);
    line("set title {} offset 0,-0.5 font ',11.5'", gnuplot_string(figure_.panels[p].title));
  }

  // Of panels over one another with a common x axis only the lowest writes its numbers.
  bool is_stacked_above(std::size_t p) const {
    return figure_.columns <= 1 && p + 1 < figure_.panels.size() &&
           figure_.panels[p].x.label.empty();
  }

  void axis(const char* name, const Axis& axis, bool numbers) {
    line("set {}label {}", name, gnuplot_string(axis.label));
    line("{} logscale {}", set_or_unset(axis.scale), name);
    line("unset {0}tics\nset {0}tics autofreq nomirror out scale 0.6 tc rgb '#333333' format '{1}'",
         name, numbers ? "%g" : "");
    line("set {}range [{}:{}] noreverse", name, bound(axis.low), bound(axis.high));
  }
  static const char* set_or_unset(AxisScale scale) {
    return scale == AxisScale::logarithmic ? "set" : "unset";
  }
  static std::string bound(double value) {
    return std::isfinite(value) ? fmt::format("{:.12g}", value) : "*";
  }

  std::string add_file(std::string content) {
    job_.files.push_back({fmt::format("{}.txt", job_.files.size()), std::move(content)});
    return job_.files.back().name;
  }

  // Curves of one name look the same where the legend is shared.
  std::size_t look_of(const std::string& name, std::size_t in_panel) {
    if (!figure_.shared_legend) return in_panel;
    const auto known = std::ranges::find(names_, name);
    if (known != names_.end()) return static_cast<std::size_t>(known - names_.begin());
    names_.push_back(name);
    return names_.size() - 1;
  }

  static std::string look(std::size_t number, CurveStyle style, std::size_t points) {
    const char* colour = colours[number % colours.size()];
    const char* dash = dashes[number / colours.size() % dashes.size()];
    const int mark = marks[number % marks.size()];
    if (style == CurveStyle::points)
      return fmt::format("with points lc rgb '{}' pt {} ps 1.5 lw 1.5", colour, mark);
    const std::string line = fmt::format("lc rgb '{}' dt {} lw 1.8", colour, dash);
    if (style == CurveStyle::line) return "with lines " + line;
    // On long curves marks all along would be a smear.
    return fmt::format("with linespoints {} pt {} ps 0.9{}", line, mark,
                       points > 24 ? " pn 8" : "");
  }

  void curves(std::size_t p) {
    const Panel& panel = figure_.panels[p];
    std::vector<std::string> parts;
    bool anything = false;
    for (std::size_t c = 0; c < panel.curves.size(); ++c) {
      const Curve& curve = panel.curves[c];
      const std::string looks = look(look_of(curve.name, c), curve.style, curve.points.size());
      const std::string title = curve.name.empty() || figure_.shared_legend
                                    ? "notitle"
                                    : "title " + gnuplot_string(curve.name);
      if (std::string data = curve_data(curve, panel); !data.empty()) {
        parts.push_back(
            fmt::format("'{}' using 1:2 {} {}", add_file(std::move(data)), looks, title));
        anything = true;
      } else if (title != "notitle") {
        parts.push_back(fmt::format("keyentry {} {}", looks, title));
      }
    }
    add_shared_legend(p, parts);
    const PlotBox& box = layout_.axes[figure_.shared_legend ? shared_legend_panel() : p];
    line(
        "set key at screen {:.5f},{:.5f} left top Left reverse samplen 2.6 spacing 1.15 noenhanced "
        "tc rgb '#222222'",
        (box.right + layout_.legend_gap) / layout_.width,
        (layout_.axes[p].top + 6) / layout_.height);
    // gnuplot has no axes without something to draw.
    if (!anything) no_data(panel, parts);
    std::string plot;
    for (const std::string& part : parts) plot += (plot.empty() ? "plot " : ", \\\n     ") + part;
    line("{}", plot);
    if (!anything) line("unset label 999");
  }

  void no_data(const Panel& panel, std::vector<std::string>& parts) {
    line("set label 999 'no data' at graph 0.5,0.5 center tc rgb '#777777'");
    for (const auto& [name, axis] : {std::pair("x", panel.x), std::pair("y", panel.y)})
      if (!std::isfinite(axis.low) || !std::isfinite(axis.high)) line("set {}range [1:10]", name);
    parts.insert(parts.begin(), "NaN notitle");
  }

  // The panel whose right side is the figure's: the last of the first row.
  std::size_t shared_legend_panel() const {
    return std::min(figure_.panels.size(), static_cast<std::size_t>(std::max(1, figure_.columns))) -
           1;
  }

  // gnuplot has no legend that is higher than the panel that it belongs to: each row of panels
  // takes its share.
  void add_shared_legend(std::size_t p, std::vector<std::string>& parts) {
    if (!figure_.shared_legend) return;
    const std::size_t columns = static_cast<std::size_t>(std::max(1, figure_.columns)),
                      row = p / columns;
    if (p % columns != columns - 1 && p + 1 != figure_.panels.size()) return;
    const std::vector<const Curve*> legend = shared_legend(figure_);
    const std::size_t share = shared_legend_rows(figure_),
                      end = std::min(legend.size(), (row + 1) * share);
    for (std::size_t k = row * share; k < end; ++k)
      parts.push_back(fmt::format("keyentry {} title {}",
                                  look(look_of(legend[k]->name, 0), legend[k]->style, 0),
                                  gnuplot_string(legend[k]->name)));
  }

  void heat_map(std::size_t p) {
    const HeatMap& map = figure_.panels[p].heat_map.front();
    const std::size_t columns = static_cast<std::size_t>(std::max(1, figure_.columns));
    tics("x", p + columns < figure_.panels.size() ? std::vector<std::string>{} : map.columns);
    tics("y", p % columns > 0 ? std::vector<std::string>{} : map.rows);
    line("set xrange [-0.5:{}]\nset yrange [{}:-0.5]",
         static_cast<double>(map.columns.size()) - 0.5, static_cast<double>(map.rows.size()) - 0.5);
    line("unset grid\nset palette defined ({})", heat_palette(map.diverging));
    line("{} logscale cb", set_or_unset(map.scale));
    line("set cbrange [{:.9g}:{:.9g}]\nset cblabel {}\nset format cb '%g'", colour_range_.low,
         colour_range_.high, gnuplot_string(map.label));
    const PlotBox& bar = layout_.colour_bar;
    if (p == 0)
      line("set colorbox user origin screen {:.5f},{:.5f} size screen {:.5f},{:.5f}",
           bar.left / layout_.width, bar.bottom / layout_.height,
           (bar.right - bar.left) / layout_.width, (bar.top - bar.bottom) / layout_.height);
    else
      line("unset colorbox");
    line("{}", cells(map));
    line("set grid");
  }

  void tics(const char* axis, const std::vector<std::string>& labels) {
    if (labels.empty()) {
      line("unset {}tics", axis);
      return;
    }
    std::string text;
    for (std::size_t k = 0; k < labels.size(); ++k)
      text += fmt::format("{}{} {}", k ? ", " : "", gnuplot_string(labels[k]), k);
    line("set {}tics scale 0 ({})", axis, text);
  }

  std::string cells(const HeatMap& map) {
    std::string filled, empty, texts;
    for (std::size_t k = 0; k < map.values.size(); ++k) {
      const double x = static_cast<double>(k % map.columns.size()),
                   y = static_cast<double>(k / map.columns.size()), value = map.values[k];
      const bool here = std::isfinite(value) && (map.scale == AxisScale::linear || value > 0.0);
      const std::string box =
          fmt::format("{} {} {} {} {} {}", x, y, x - 0.5, x + 0.5, y - 0.5, y + 0.5);
      if (here)
        filled += fmt::format("{} {:.9g}\n", box,
                              std::clamp(value, colour_range_.low, colour_range_.high));
      else
        empty += box + "\n";
      if (!map.texts.empty() && !map.texts[k].empty()) {
        const bool light = here && needs_light_text(colour_range_, map, value);
        std::string text = map.texts[k];
        std::erase_if(text, [](unsigned char c) { return c == '"' || c == '\\' || c < 32; });
        texts += fmt::format("{} {} {} \"{}\"\n", x, y, light ? 0xffffff : 0x111111, text);
      }
    }
    std::string plot;
    const auto add = [&](std::string data, const char* how) {
      if (!data.empty())
        plot += fmt::format("{}'{}' {} notitle", plot.empty() ? "plot " : ", ",
                            add_file(std::move(data)), how);
    };
    add(std::move(empty),
        "using 1:2:3:4:5:6 with boxxyerror fs solid border lc rgb '#ffffff' fc rgb '#e4e4e4'");
    add(std::move(filled), "using 1:2:3:4:5:6:7 with boxxyerror fs solid noborder lc palette");
    add(std::move(texts), "using 1:2:4:3 with labels font ',9' tc rgb variable");
    return plot.empty() ? "plot NaN notitle" : plot;
  }

  const Figure& figure_;
  PlotLayout layout_;
  GnuplotJob job_;
  HeatRange colour_range_;
  std::vector<std::string> names_;
  int labels_ = 0;
};

}  // namespace

GnuplotJob gnuplot_job(const Figure& figure, bool svg) { return ScriptWriter(figure, svg).write(); }

std::string gnuplot_string(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') quoted += '\'';
    quoted += static_cast<unsigned char>(c) < 32 ? ' ' : c;
  }
  return quoted + "'";
}

}  // namespace taut
