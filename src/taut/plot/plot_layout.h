#pragma once
// Where the parts of a figure stand, in pixels from its lower left corner.

#include "taut/plot/figure.h"

namespace taut {

struct PlotBox {
  double left = 0, bottom = 0, right = 0, top = 0;
};

struct PlotLayout {
  int width = 0, height = 0;
  std::vector<PlotBox> axes;  // a panel each: the frame, without its labels
  PlotBox colour_bar;         // of heat maps; empty when there is none
  double legend_gap = 12;     // from a frame's right side to its legend
};

PlotLayout lay_out(const Figure& figure);
// What a shared legend lists: the first curve of each name; and how many of them stand beside each
// row of panels.
std::vector<const Curve*> shared_legend(const Figure& figure);
std::size_t shared_legend_rows(const Figure& figure);

}  // namespace taut
