#pragma once
// FIRST:LAST[:STEP] on the command line: which frames of a result. FIRST or LAST may be left out:
// the first, the last there is.

#include <CLI/CLI.hpp>

#include "taut/results/result_frames.h"

namespace taut::app {

struct FrameRange {
  int first = 0, last = 0, stride = 1;
};

// For CLI::Option::check.
CLI::Validator frame_range_syntax();
// The last frame there is; where later ones follow behind one that is missing, says so on stderr.
int last_frame_said(const ResultFrames& frames);
// `text` has passed the check, or is empty: all frames. Throws InputError when the result lacks one
// of them.
FrameRange chosen_frames(const std::string& text, const ResultFrames& frames);

}  // namespace taut::app
