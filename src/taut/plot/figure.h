#pragma once
// Figures: curves and heat maps in panels, drawn by gnuplot into an SVG or PNG file.
//
//   Figure    a title over panels, filled row by row into `columns` columns
//   Panel     one pair of axes with curves, or a heat map
//   Curve     points (x, y) in the order in which they are joined; one that is not finite, or not
//             positive on a logarithmic axis, is a gap
//   HeatMap   values[row * columns + column], row 0 on top; one that is not finite is an empty cell
//
// Colours are those of Okabe & Ito ("Color Universal Design", 2008), which colour-blind readers can
// tell apart; each round through them has a dash pattern and a mark of its own, so that 28 curves
// look different. Text is drawn as it is given: nothing in it is markup or a command.

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace taut {

enum class AxisScale { linear, logarithmic };

struct Axis {
  std::string label;
  AxisScale scale = AxisScale::linear;
  double low = NAN, high = NAN;  // not finite: from the data
};

enum class CurveStyle { line, line_and_points, points };

struct PlotPoint {
  double x = 0.0, y = 0.0;
};

struct Curve {
  std::string name;  // in the legend; empty: not there
  std::vector<PlotPoint> points;
  CurveStyle style = CurveStyle::line;
};

struct HeatMap {
  std::vector<std::string> rows, columns;  // labels
  std::vector<double> values;
  std::vector<std::string> texts;  // what stands in the cells; empty, or as many as values
  std::string label;               // of the values, at the colour bar
  AxisScale scale = AxisScale::linear;
  // of the colours; not finite: from the data of all heat maps of the figure
  double low = NAN, high = NAN;
  // Two colours that meet at 1 (logarithmic) or 0 (linear), for ratios and differences; the
  // colours' range is then symmetric about it.
  bool diverging = false;
};

struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Curve> curves;
  std::vector<HeatMap> heat_map;  // none or one; then `curves` is not drawn
};

struct Figure {
  std::string title, note;  // the note stands below everything, in small letters
  std::vector<Panel> panels;
  int columns = 1;
  // One legend for all panels: curves of the same name look the same. Else each panel has its own.
  // Heat maps always share one colour bar.
  bool shared_legend = false;
  int panel_width = 0, panel_height = 0;  // pixels; 0: chosen
};

// Writes `path`, whole or not at all; its ending (.svg, .png) says the form. Throws InputError when
// the ending is another, when gnuplot is not installed (with what to install) or when it fails
// (with what it said).
void draw_figure(const Figure& figure, const std::filesystem::path& path);
// Throws as draw_figure would for this name: to be asked before an hour of measuring.
void check_figure_file(const std::filesystem::path& path);

}  // namespace taut
