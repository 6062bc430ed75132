#pragma once
// Colours of heat maps: viridis (Smith & van der Walt 2015) for amounts, purple over
// white to orange (ColorBrewer's PuOr) for ratios and differences. Both stay in order
// for colour-blind readers.

#include "taut/plot/figure.h"

namespace taut {

struct HeatRange {
  double low = 0.0, high = 1.0;
};

// Of all heat maps of the figure together.
HeatRange heat_range(const Figure& figure);
// As gnuplot's `set palette defined` wants it.
const char* heat_palette(bool diverging);
// Whether the colour of `value` is so dark that black letters on it could not be read.
bool needs_light_text(const HeatRange& range, const HeatMap& map, double value);

}  // namespace taut
