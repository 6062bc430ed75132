#pragma once
// What has become of a run, told from its folder alone:
//
//   status       when
//   empty        nothing of `taut run` is there
//   starting     scene.toml is there, no stats.csv yet
//   running      a living process writes stats.csv (base/file_lock.h)
//   finished     summary.json says so; likewise `interrupted` and `failed`, with the message there.
//                Also frames without a scene, which somebody else has made
//   crashed      steps were written, nobody writes any more, and there is no summary: the simulator
//                was killed

#include <nlohmann/json.hpp>

#include "view/result_files.h"

namespace taut::app {

class RunStateReader {
 public:
  explicit RunStateReader(const ResultFiles& files) : files_(files) {}
  // {"status", "message", "folder", "run", "stats", "frames"}: `run` changes when the folder is
  // filled anew, `stats` when stats.csv is replaced (a run that was resumed), `frames` counts from
  // 0 without a gap. Not for several threads at once.
  nlohmann::ordered_json read();

 private:
  int frame_count(const std::string& run);
  const ResultFiles& files_;
  std::string last_run_;
  int last_count_ = 0;
};

}  // namespace taut::app
