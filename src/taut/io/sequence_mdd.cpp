// STEM.obj has the mesh at the first frame, STEM.mdd moves it; what does not move has no cache.
//
//   MDD, all big-endian:  int32 frames, int32 points, float time of each frame (s), then for each
//                         frame points x 3 float32
//
// Source: the LightWave MDD format as Blender's io_shape_mdd writes it.
#include <ostream>

#include "taut/base/file.h"
#include "taut/io/little_endian.h"
#include "taut/io/obj.h"
#include "taut/io/sequence_formats.h"
#include "taut/io/spool_file.h"

namespace taut::detail {

namespace {

class MddSequence : public SequenceWriter {
 public:
  using SequenceWriter::SequenceWriter;

  void finish() override {
    for (std::size_t k = 0; k < spools_.size(); ++k) {
      if (!spools_[k]) continue;
      std::string head;
      append_big_endian(head, static_cast<std::int32_t>(frames_added()));
      append_big_endian(head, std::int32_t{objects()[k].points});
      write_file(file(objects()[k].stem + ".mdd"), [&](std::ostream& out) {
        out << head << times_;
        spools_[k]->copy_to(out);
      });
    }
  }

 private:
  void write_frame(int number, std::span<const ObjectFrame> frame) override {
    if (is_first()) spools_.resize(frame.size());
    append_big_endian(times_, static_cast<float>(time_of(number)));
    for (std::size_t k = 0; k < frame.size(); ++k) {
      const SequenceObject& object = objects()[k];
      if (is_first()) {
        write_obj(file(object.stem + ".obj"), mesh_at(object, frame[k]), ObjDigits::of_float);
        if (object.moves) spools_[k] = std::make_unique<SpoolFile>(options().folder);
      }
      if (!spools_[k]) continue;
      std::string bytes;
      for (const double x : flat(frame[k].points)) append_big_endian(bytes, static_cast<float>(x));
      spools_[k]->append(bytes);
    }
  }

  std::string times_;
  std::vector<std::unique_ptr<SpoolFile>> spools_;
};

}  // namespace

std::unique_ptr<SequenceWriter> make_mdd_sequence(SequenceOptions options,
                                                  std::vector<SequenceObject> objects) {
  return std::make_unique<MddSequence>(std::move(options), std::move(objects));
}

}  // namespace taut::detail
