#include "taut/sim/schema.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace taut {

namespace {

std::string with_unit(const std::string& text, const KeyInfo& info) {
  return *info.unit ? text + " " + info.unit : text;
}

}  // namespace

std::string range_text(const KeyInfo& info) {
  const bool low = std::isfinite(info.min), high = std::isfinite(info.max);
  if (!low && !high) return {};
  std::string text;
  if (low && high && !info.above_min) {
    text = fmt::format("from {:g} to {:g}", info.min, info.max);
  } else {
    if (low) text = fmt::format("{} {:g}", info.above_min ? "above" : "at least", info.min);
    if (high) text += fmt::format("{}at most {:g}", low ? ", " : "", info.max);
  }
  return with_unit(text, info);
}

std::string problem_of(double value, const KeyInfo& info) {
  if (!std::isfinite(value))
    return fmt::format(" = {} is not a finite number: give a number that is", value);
  if (value <= info.max && (info.above_min ? value > info.min : value >= info.min)) return {};
  return fmt::format(" = {} is out of range: expected {}{}{}",
                     with_unit(fmt::format("{}", value), info), range_text(info),
                     *info.hint ? "; " : "", info.hint);
}

std::string unknown_name(const std::string& name, std::span<const char* const> names) {
  const std::vector<std::string> known(names.begin(), names.end());
  const std::string near = nearest_name(name, known);
  return fmt::format(": \"{}\" is not known: expected one of \"{}\"{}", name,
                     fmt::join(names, "\", \""),
                     near.empty() ? "" : "; did you mean '" + near + "'?");
}

}  // namespace taut
