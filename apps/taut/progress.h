#pragma once
// What one sees while a simulation runs: in a terminal one line that is rewritten, else a plain line now and then; with --quiet nothing; with --json-lines
// one JSON object a step on stdout.

#include <memory>

#include "taut/scene/run.h"

namespace taut::app {

enum class ProgressStyle { automatic, quiet, json_lines };

std::unique_ptr<RunObserver> make_progress(ProgressStyle style, const Scene& scene);

}  // namespace taut::app
