#include "argument_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "taut/base/error.h"
#include "taut/solve/solver.h"

namespace taut::app {

namespace {

// CLI11's own checks print the largest double with all its 309 digits and small bounds as 0.000000.
template <class Holds>
CLI::Validator number(const std::string& expected, Holds holds) {
  return {[=](const std::string& text) {
            double value = 0.0;
            if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && holds(value))
              return std::string();
            return fmt::format("{} is not allowed: a number {} was expected", text, expected);
          },
          ""};
}

}  // namespace

CLI::Validator at_least(double low) {
  return number(fmt::format("of at least {:.10g}", low),
                [=](double value) { return value >= low; });
}

CLI::Validator above(double low) {
  return number(fmt::format("above {:.10g}", low), [=](double value) { return value > low; });
}

CLI::Validator between(double low, double high) {
  return number(fmt::format("from {:.10g} to {:.10g}", low, high),
                [=](double value) { return value >= low && value <= high; });
}

CLI::Validator solver_name() {
  return {[](const std::string& text) {
            if (is_solver_name(text)) return std::string();
            const std::vector<std::string> known = solver_names();
            const std::string near = nearest_name(text, known);
            return fmt::format("'{}' is no solver of this program; {}there are {}", text,
                               near.empty() ? "" : "did you mean '" + near + "'? ",
                               fmt::join(known, ", "));
          },
          ""};
}

}  // namespace taut::app
