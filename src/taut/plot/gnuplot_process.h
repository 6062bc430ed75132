#pragma once
// Runs gnuplot on a script in a folder of its own, without a shell.

#include <filesystem>

#include "taut/plot/gnuplot_script.h"

namespace taut {

// Returns what gnuplot drew. Throws InputError: not installed, or failed, with
// the end of what it said.
std::string run_gnuplot(const GnuplotJob& job);

}  // namespace taut
