#pragma once
// What one sees while a simulation runs, on stderr: in a terminal one line that is rewritten ten
// times a second (a bar, frame, time left, simulated time, speed, iterations, stretch, contacts;
// what the terminal is too narrow for is left out), else a plain line every five seconds. With
// --quiet nothing. With --json-lines one JSON object a step on stdout (step, steps, frame, frames,
// time, solver, iterations, contacts, max_stretch, kinetic_J, elastic_J, step_ms, steps_per_s,
// left_s), and {"message": "..."} for what the user should know.

#include <memory>

#include "taut/results/run.h"

namespace taut::app {

enum class ProgressStyle { automatic, quiet, json_lines };

std::unique_ptr<RunObserver> make_progress(ProgressStyle style, const Scene& scene);

}  // namespace taut::app
