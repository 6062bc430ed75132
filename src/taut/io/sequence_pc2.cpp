// STEM.obj has the mesh at the first frame, STEM.pc2 moves it; what does not move has no cache.
#include "taut/io/obj.h"
#include "taut/io/pc2.h"
#include "taut/io/sequence_formats.h"

namespace taut::detail {

namespace {

class Pc2Sequence : public SequenceWriter {
 public:
  using SequenceWriter::SequenceWriter;

  void finish() override {
    for (const auto& cache : caches_)
      if (cache) cache->finish();
  }

 private:
  void write_frame(int number, std::span<const ObjectFrame> frame) override {
    if (is_first()) caches_.resize(frame.size());
    for (std::size_t k = 0; k < frame.size(); ++k) {
      const SequenceObject& object = objects()[k];
      if (is_first()) {
        write_obj(file(object.stem + ".obj"), mesh_at(object, frame[k]), ObjDigits::of_float);
        if (object.moves)
          caches_[k] = std::make_unique<Pc2Writer>(file(object.stem + ".pc2"), object.points,
                                                   static_cast<float>(number),
                                                   static_cast<float>(options().frame_stride));
      }
      if (caches_[k]) caches_[k]->add_sample(frame[k].points);
    }
  }

  std::vector<std::unique_ptr<Pc2Writer>> caches_;
};

}  // namespace

std::unique_ptr<SequenceWriter> make_pc2_sequence(SequenceOptions options,
                                                  std::vector<SequenceObject> objects) {
  return std::make_unique<Pc2Sequence>(std::move(options), std::move(objects));
}

}  // namespace taut::detail
