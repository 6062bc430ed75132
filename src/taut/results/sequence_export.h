#pragma once
// Frames of a results folder as files of other programs (io/sequence_writer.h): one object a cloth
// and solid, in this order; vertex order and texture coordinates kept. Cloths have the fields
// velocity, stretch and contact (results/result_frames.h).
//
//   scale   file coordinates = scale * metres
//   up      z: as Taut; y: (x, y, z) becomes (x, z, -y)

#include <optional>

#include "taut/io/sequence_writer.h"
#include "taut/results/result_frames.h"
#include "taut/results/solid_shapes.h"

namespace taut {

struct SequenceExportOptions {
  std::string format = "usd";
  std::filesystem::path folder;  // where to write
  std::string file_name = {};  // as in SequenceOptions
  double scale = 1.0;
  std::optional<UpAxis> up;  // default: the format's usual
  int first = 0;
  int last = 0;  // as far as known beforehand; more frames than that must not be added
  int stride = 1;
};

class SequenceExport {
 public:
  // `frames` must outlive the export. Throws InputError for bad options, or as
  // make_sequence_writer.
  SequenceExport(const ResultFrames& frames, const SequenceExportOptions& options);

  // Adds the chosen frames up to this one that have not been added; they must be in the results
  // folder.
  void add_frames_until(int frame);
  int frames_added() const { return writer_->frames_added(); }
  // Meshes in the folder that an earlier export of the same objects has left, of frames that this
  // one has not added: other programs would take them for part of the sequence.
  std::vector<std::filesystem::path> files_of_other_frames() const;
  // Where what was written is: the folder, or the file that was chosen; where that was not one but
  // several, a pattern of their names.
  std::string written_to() const;
  // Ends what has at least one frame. Without it, what was begun is taken back.
  void finish();

 private:
  std::vector<ObjectFrame> objects_at(int frame) const;
  Vec3 turned(const Vec3& v) const { return up_ == UpAxis::z ? v : Vec3(v.x(), v.z(), -v.y()); }

  const ResultFrames& frames_;
  SolidShapes solids_;
  SequenceExportOptions options_;
  UpAxis up_;
  int next_;
  std::unique_ptr<SequenceWriter> writer_;
};

}  // namespace taut
