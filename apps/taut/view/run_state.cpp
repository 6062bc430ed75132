#include "view/run_state.h"

#include "taut/base/error.h"
#include "taut/base/file_lock.h"

namespace taut::app {

namespace {

struct Status {
  std::string name, message;
};

Status ended(const OpenFile& summary) {
  const auto json = nlohmann::json::parse(summary.read(0, summary.size()), nullptr, false);
  if (!json.is_object()) return {"crashed", "summary.json cannot be read"};
  const auto text = [&](const char* key) {
    return json.contains(key) && json[key].is_string() ? json[key].get<std::string>()
                                                       : std::string();
  };
  const std::string status = text("status");
  return {status == "interrupted" || status == "failed" ? status : "finished", text("message")};
}

Status status_of(const ResultFiles& files, const std::optional<OpenFile>& stats) {
  if (stats && is_being_written(stats->descriptor())) return {"running", ""};
  if (const auto summary = files.open("summary.json")) return ended(*summary);
  if (stats)
    return {"crashed",
            "the simulator is gone and has left no summary: it was killed, or the machine stopped"};
  if (files.open("scene.toml")) return {"starting", ""};
  if (files.open_in_frames("triangles.npy")) return {"finished", ""};
  return {"empty", "holds no result of `taut run` yet"};
}

std::string identity_of(const std::optional<OpenFile>& file) {
  return file ? file->identity() : std::string();
}

}  // namespace

// Counts on from where it was: only what is new costs a look.
int RunStateReader::frame_count(const std::string& run) {
  if (run != last_run_ || (last_count_ > 0 && !files_.has_frame(last_count_ - 1))) last_count_ = 0;
  last_run_ = run;
  while (files_.has_frame(last_count_)) ++last_count_;
  return last_count_;
}

nlohmann::ordered_json RunStateReader::read() {
  const auto stats = files_.open("stats.csv");
  const Status status = status_of(files_, stats);
  const std::string run =
      identity_of(files_.open("scene.toml")) + identity_of(files_.open_in_frames("triangles.npy"));
  return {{"status", status.name},
          {"message", status.message},
          {"folder", files_.folder().string()},
          {"run", run},
          {"stats", identity_of(stats)},
          {"frames", frame_count(run)}};
}

}  // namespace taut::app
