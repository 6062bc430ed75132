#include "frame_range.h"

#include <fmt/format.h>

#include <optional>

#include "taut/base/error.h"

namespace taut::app {

namespace {

// Negative: left out.
std::optional<FrameRange> parse(const std::string& text) {
  int numbers[3] = {-1, -1, -1};
  std::size_t part = 0;
  for (const char c : text) {
    if (c == ':') {
      if (++part == 3) return std::nullopt;
      continue;
    }
    if (c < '0' || c > '9' || numbers[part] > 100'000'000) return std::nullopt;
    numbers[part] = std::max(numbers[part], 0) * 10 + (c - '0');
  }
  if (part == 0) numbers[1] = numbers[0];  // one number is one frame
  if (numbers[2] == 0 || (numbers[1] >= 0 && numbers[1] < numbers[0])) return std::nullopt;
  return FrameRange{numbers[0], numbers[1], std::max(numbers[2], 1)};
}

}  // namespace

CLI::Validator frame_range_syntax() {
  return {[](const std::string& text) {
            return parse(text) ? std::string()
                               : "'" + text +
                                     "' is no range of frames; FIRST:LAST or FIRST:LAST:STEP was "
                                     "expected, such as 10:50";
          },
          ""};
}

int last_frame_said(const ResultFrames& frames) {
  const int last = frames.last_frame();
  if (frames.results().has_gap())
    fmt::print(stderr,
               "note: {} is missing although there are later frames; only 0 to {} are used. Run "
               "the scene anew to have them all\n",
               frames.results().frame_file(last + 1).string(), last);
  return last;
}

FrameRange chosen_frames(const std::string& text, const ResultFrames& frames) {
  FrameRange range = parse(text).value_or(FrameRange{-1, -1, 1});
  const int last = last_frame_said(frames);
  range.first = std::max(range.first, 0);
  if (range.last < 0) range.last = last;
  if (range.last > last || range.first > last)
    throw InputError({frames.results().folder().string()},
                     fmt::format("has the frames 0 to {}; {} was asked for", last, text));
  return range;
}

}  // namespace taut::app
