#include "view/result_routes.h"

#include <algorithm>
#include <charconv>

#include "taut/base/error.h"
#include "view/scene_json.h"

namespace taut::app {

namespace {

constexpr std::size_t most_frame_bytes = std::size_t{64} << 20;
constexpr const char* binary = "application/octet-stream";

// A count from 0, at most `most`.
std::int64_t number(const Parameters& parameters, const std::string& key, std::int64_t most) {
  const auto given = parameters.find(key);
  if (given == parameters.end()) throw Refusal{400, "the parameter '" + key + "' is missing"};
  const std::string& text = given->second;
  std::int64_t value = -1;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size() || value < 0 || value > most)
    throw Refusal{400,
                  "the parameter '" + key + "' must be a number from 0 to " + std::to_string(most)};
  return value;
}

// Of a solid that is a mesh: the parameter is its number.
std::string solid_file(const Parameters& parameters, const char* what) {
  return "solid_" + std::to_string(number(parameters, "solid", 999'999)) + "_" + what + ".npy";
}

Answer array_answer(const ArrayFile& array) {
  return {array.bytes(),
          binary,
          [array](std::size_t offset, std::size_t most) {
            return array.file.read(array.header.data_start + offset, most);
          },
          {}};
}

using OpenFrame = std::optional<ArrayFile> (ResultFiles::*)(int) const;

// Consecutive frames of one size; the file of the one being read stays open.
class FrameReader {
 public:
  FrameReader(const ResultFiles& files, OpenFrame open, int first, std::size_t frame_bytes)
      : files_(files), open_frame_(open), first_(first), frame_bytes_(frame_bytes) {}
  std::string operator()(std::size_t offset, std::size_t most) {
    const int frame = first_ + static_cast<int>(offset / frame_bytes_);
    const std::size_t within = offset % frame_bytes_;
    if (frame != open_) array_ = (files_.*open_frame_)(frame), open_ = frame;
    if (!array_ || array_->bytes() != frame_bytes_)
      throw Refusal{404, "the frames have changed meanwhile"};
    return array_->file.read(array_->header.data_start + within,
                             std::min(most, frame_bytes_ - within));
  }

 private:
  const ResultFiles& files_;
  OpenFrame open_frame_;
  int first_, open_ = -1;
  std::size_t frame_bytes_;
  std::optional<ArrayFile> array_;
};

}  // namespace

Answer whole_answer(std::string content, std::string type) {
  const auto text = std::make_shared<const std::string>(std::move(content));
  return {text->size(),
          std::move(type),
          [text](std::size_t offset, std::size_t most) { return text->substr(offset, most); },
          {}};
}

Answer ResultRoutes::answer(const std::string& name, const Parameters& parameters) {
  if (name == "state") return state();
  if (name == "scene") {
    if (!files_.open_in_frames("triangles.npy") || !files_.has_frame(0))
      throw Refusal{404, "there is no frame yet"};
    return whole_answer(scene_json(files_).dump(), "application/json");
  }
  if (name == "triangles") return array("triangles.npy", "<i4", 3);
  if (name == "uv") return array("uv.npy", "<f4", 2);
  if (name == "springs") return array("stretch_springs.npy", "<i4", 2);
  if (name == "rest_lengths") return array("rest_lengths.npy", "<f4", 1);
  if (name == "solid_triangles") return array(solid_file(parameters, "triangles"), "<i4", 3);
  if (name == "solid_points") return array(solid_file(parameters, "points"), "<f4", 3);
  if (name == "frames") return frames(parameters, false);
  if (name == "contact") return frames(parameters, true);
  if (name == "stats") return stats(parameters);
  throw Refusal{404, "there is nothing of this name"};
}

Answer ResultRoutes::state() {
  const std::lock_guard lock(state_mutex_);
  return whole_answer(state_.read().dump(), "application/json");
}

Answer ResultRoutes::array(const std::string& file, const char* type, int row) const {
  const auto found = files_.open_array(file, type, row);
  if (!found) throw Refusal{404, "frames/" + file + " is not there"};
  return array_answer(*found);
}

Answer ResultRoutes::frames(const Parameters& parameters, bool contact) const {
  const OpenFrame open = contact ? &ResultFiles::open_contact : &ResultFiles::open_frame;
  const int first = static_cast<int>(number(parameters, "first", 999'999'999)),
            wanted = static_cast<int>(number(parameters, "count", 100'000));
  const auto array = (files_.*open)(first);
  if (!array || wanted == 0) throw Refusal{404, "there is no such frame yet"};
  const std::size_t bytes = array->bytes();
  if (bytes == 0) throw Refusal{404, "the frame has no nodes"};
  const int most = std::max(1, static_cast<int>(std::min<std::size_t>(
                                   static_cast<std::size_t>(wanted), most_frame_bytes / bytes)));
  int count = 1;
  while (count < most &&
         (contact ? files_.has_contact(first + count) : files_.has_frame(first + count)))
    ++count;
  const auto reader = std::make_shared<FrameReader>(files_, open, first, bytes);
  return {bytes * static_cast<std::size_t>(count),
          binary,
          [reader](std::size_t offset, std::size_t length) { return (*reader)(offset, length); },
          {}};
}

Answer ResultRoutes::stats(const Parameters& parameters) const {
  const auto file = files_.open("stats.csv");
  if (!file) throw Refusal{404, "there is no stats.csv yet"};
  const std::size_t from =
      static_cast<std::size_t>(number(parameters, "from", std::int64_t{1} << 50));
  const std::size_t size = file->size();
  std::string rows = from < size ? file->read(from, size - from) : std::string();
  rows.resize(rows.rfind('\n') + 1);  // npos + 1 is 0
  Answer answer = whole_answer(std::move(rows), "text/csv; charset=utf-8");
  answer.headers["Taut-Stats"] = file->identity();
  return answer;
}

}  // namespace taut::app
