#include "taut/plot/heat_colours.h"

#include <algorithm>

namespace taut {

namespace {

bool usable(const HeatMap& map, double value) {
  return std::isfinite(value) && (map.scale == AxisScale::linear || value > 0.0);
}

HeatRange symmetric(const HeatMap& map, HeatRange range) {
  if (map.scale == AxisScale::linear) {
    const double size = std::max(std::abs(range.low), std::abs(range.high));
    return {-size, size};
  }
  const double factor = std::max(range.high, 1.0 / range.low);
  return {1.0 / factor, factor};
}

}  // namespace

HeatRange heat_range(const Figure& figure) {
  HeatRange range{INFINITY, -INFINITY};
  const HeatMap* last = nullptr;
  for (const Panel& panel : figure.panels)
    for (const HeatMap& map : panel.heat_map) {
      for (const double value : map.values)
        if (usable(map, value)) range = {std::min(range.low, value), std::max(range.high, value)};
      last = &map;
    }
  if (!last) return {};
  if (!(range.low <= range.high)) range = {1.0, 2.0};
  if (std::isfinite(last->low)) range.low = last->low;
  if (std::isfinite(last->high)) range.high = last->high;
  if (last->diverging) range = symmetric(*last, range);
  if (!(range.low < range.high))
    range = last->scale == AxisScale::linear ? HeatRange{range.low - 0.5, range.low + 0.5}
                                             : HeatRange{range.low / 2, range.low * 2};
  return range;
}

const char* heat_palette(bool diverging) {
  return diverging ? "0 '#542788', 1 '#998ec3', 2 '#d8daeb', 3 '#f7f7f7', 4 '#fee0b6', 5 "
                     "'#f1a340', 6 '#b35806'"
                   : "0 '#440154', 1 '#482878', 2 '#3e4989', 3 '#31688e', 4 '#26828e', 5 "
                     "'#1f9e89', 6 '#35b779', 7 '#6ece58', 8 '#b5de2b', "
                     "9 '#fde725'";
}

bool needs_light_text(const HeatRange& range, const HeatMap& map, double value) {
  const auto place = [&](double v) { return map.scale == AxisScale::linear ? v : std::log(v); };
  const double t = (place(std::clamp(value, range.low, range.high)) - place(range.low)) /
                   (place(range.high) - place(range.low));
  return map.diverging ? t < 0.15 || t > 0.92 : t < 0.55;
}

}  // namespace taut
