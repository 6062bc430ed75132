#pragma once
// What an option's value may be, checked before anything is read or written; a value that may not
// be is bad usage (exit code 2).

#include <CLI/CLI.hpp>

namespace taut::app {

CLI::Validator at_least(double low);
CLI::Validator above(double low);
CLI::Validator between(double low, double high);  // both included
// A name of solver_names().
CLI::Validator solver_name();

}  // namespace taut::app
