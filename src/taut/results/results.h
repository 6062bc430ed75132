#pragma once
// The folder that `taut run` writes: docs/results.md names each file, its shape and units.
//
//   scene.toml, frames/, stats.csv, summary.json, checkpoint/state.bin, contact_sheet.png,
//   last_good/ of a run that failed, stats.svg where `taut plot` was asked for it
//
// Every file is written whole or not at all; stats.csv grows by whole rows. While a run lasts,
// stats.csv is marked as being written (base/file_lock.h): that tells a run that goes on from one
// that was killed.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "taut/scene/scene_simulation.h"

namespace taut {

struct CheckpointPlace {
  int frame = 0;              // at which it was written
  bool other_length = false;  // the scene has another number of frames now
};

class ResultsFolder {
 public:
  explicit ResultsFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path scene_file() const { return folder_ / "scene.toml"; }
  std::filesystem::path frame_file(int frame) const;
  std::filesystem::path contact_file(int frame) const;
  std::filesystem::path stats_file() const { return folder_ / "stats.csv"; }
  std::filesystem::path summary_file() const { return folder_ / "summary.json"; }
  std::filesystem::path checkpoint_file() const { return folder_ / "checkpoint" / "state.bin"; }
  std::filesystem::path contact_sheet_file() const { return folder_ / "contact_sheet.png"; }

  // Makes the folder for a new run: results of an earlier run in it are removed. Throws InputError
  // when the folder holds something that is not a result of Taut's, or when a run is writing it.
  // Returns what was there where that was another scene's: in sentences, for the user.
  std::vector<std::string> start(const SceneSimulation& simulation) const;
  // Before the run goes on for another number of frames than it began with.
  void change_length(const SceneSimulation& simulation) const;
  // What processes that were killed left of files they were writing.
  void remove_unfinished() const;
  // Throws InputError while another run writes this folder.
  void refuse_running() const;
  // `contact`: as node_contact; it is there as soon as the frame is. Without it there is none.
  void write_frame(int frame, std::span<const Vec3> x,
                   std::span<const std::uint8_t> contact = {}) const;
  std::vector<Vec3> read_frame(int frame) const;
  // Nothing where the folder was written before there were such files.
  std::optional<std::vector<std::uint8_t>> read_contact(int frame) const;
  // How many frames there are, counted from 0 without a gap.
  int frame_count() const;
  // Is there a frame after the first that is missing? Such a folder was tampered with, or its disk
  // is failing.
  bool has_gap() const;
  void remove_frames_after(int frame) const;

  void write_checkpoint(const SceneSimulation& simulation, int frame) const;
  // Restores the simulation. Throws InputError when the checkpoint is missing, damaged or of
  // another scene, of which the number of frames alone may differ, or when a mesh or motion file
  // has changed since.
  CheckpointPlace read_checkpoint(SceneSimulation& simulation) const;

 private:
  std::filesystem::path folder_;
};

// stats.csv, a row a step, flushed row by row.
class StatsWriter {
 public:
  // Starts the file, or keeps the rows up to `keep_steps` of the one that is there (after a
  // resume).
  StatsWriter(const std::filesystem::path& path, int keep_steps);
  ~StatsWriter();
  StatsWriter(const StatsWriter&) = delete;
  StatsWriter& operator=(const StatsWriter&) = delete;
  void write(const StepReport& record, int frame);
  static std::string header();

 private:
  std::filesystem::path path_;
  std::FILE* file_ = nullptr;
};

}  // namespace taut
