// A mesh file a frame and object: STEM_000012.obj; what does not move has one file, STEM.obj.
#include <fmt/format.h>

#include "taut/io/obj.h"
#include "taut/io/ply.h"
#include "taut/io/sequence_formats.h"

namespace taut::detail {

namespace {

void write_float_obj(const std::filesystem::path& path, const TriangleMesh& mesh) {
  write_obj(path, mesh, ObjDigits::of_float);
}

using WriteMesh = void(const std::filesystem::path& path, const TriangleMesh& mesh);

class MeshSequence : public SequenceWriter {
 public:
  MeshSequence(SequenceOptions options, std::vector<SequenceObject> objects, WriteMesh* write,
               const char* extension)
      : SequenceWriter(std::move(options), std::move(objects)),
        write_(write),
        extension_(extension) {}
  void finish() override {}

 private:
  void write_frame(int number, std::span<const ObjectFrame> frame) override {
    for (std::size_t k = 0; k < frame.size(); ++k) {
      const SequenceObject& object = objects()[k];
      if (object.moves)
        write_(file(fmt::format("{}_{:06}{}", object.stem, number, extension_)),
               mesh_at(object, frame[k]));
      else if (is_first())
        write_(file(object.stem + extension_), mesh_at(object, frame[k]));
    }
  }

  WriteMesh* write_;
  const char* extension_;
};

}  // namespace

std::unique_ptr<SequenceWriter> make_obj_sequence(SequenceOptions options,
                                                  std::vector<SequenceObject> objects) {
  return std::make_unique<MeshSequence>(std::move(options), std::move(objects), write_float_obj,
                                        ".obj");
}

std::unique_ptr<SequenceWriter> make_ply_sequence(SequenceOptions options,
                                                  std::vector<SequenceObject> objects) {
  return std::make_unique<MeshSequence>(std::move(options), std::move(objects), write_ply, ".ply");
}

}  // namespace taut::detail
