#pragma once
// stats.csv of a run as a figure: stacked panels over simulated time.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "taut/plot/figure.h"

namespace taut::app {

// The columns of numbers of a CSV with a header; what is empty or no number is NaN. A last line
// without its end is of a run that is still being written, and is left out. Throws InputError: not
// readable, no header, or a row with another number of fields than the header.
using Columns = std::map<std::string, std::vector<double>>;
Columns read_columns(const std::filesystem::path& file);

// Iterations with their bound; milliseconds by phase; energies; largest stretch; contacts and
// constraints. Columns that are not there are left out.
Figure stats_figure(const Columns& columns, const std::string& title, const std::string& note);

}  // namespace taut::app
