#include <fmt/format.h>

#include "taut/base/error.h"
#include "taut/io/obj.h"
#include "taut/io/pc2.h"
#include "taut/scene/results.h"
#include "taut/scene/scene_file.h"
#include "verbs.h"

namespace taut::app {

namespace {

struct ExportArguments {
  std::string folder, format, out;
};

// One cloth's mesh at one frame, vertex order and texture coordinates as they came in.
TriangleMesh part_mesh(const ClothModel& cloth, const ClothPart& part, std::span<const Vec3> x) {
  TriangleMesh mesh;
  const TriangleMesh& surface = cloth.surface();
  mesh.positions.assign(x.begin() + part.first_node, x.begin() + part.first_node + part.node_count);
  mesh.texcoords.assign(surface.texcoords.begin() + part.first_node, surface.texcoords.begin() + part.first_node + part.node_count);
  for (Index t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
    Triangle triangle = surface.triangles[t];
    for (Index& node : triangle) node -= part.first_node;
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

int export_frames(const ExportArguments& arguments) {
  const ResultsFolder results(arguments.folder);
  const ClothModel cloth(read_scene(results.scene_file()));
  const int frames = results.frame_count();
  if (frames == 0) throw InputError({arguments.folder}, "holds no frames yet");
  const std::filesystem::path out = arguments.out.empty() ? results.folder() / arguments.format : std::filesystem::path(arguments.out);
  for (const ClothPart& part : cloth.parts()) {
    std::unique_ptr<Pc2Writer> cache;
    if (arguments.format == "pc2") cache = std::make_unique<Pc2Writer>(out / (part.name + ".pc2"), part.node_count);
    for (int frame = 0; frame < frames; ++frame) {
      const std::vector<Vec3> x = results.read_frame(frame);
      if (static_cast<Index>(x.size()) != cloth.nodes())
        throw InputError({results.frame_file(frame).string()}, fmt::format("has {} nodes, the scene has {}", x.size(), cloth.nodes()));
      // A point cache moves a mesh: its first frame goes beside it.
      if (!cache)
        write_obj(out / fmt::format("{}_{:06}.obj", part.name, frame), part_mesh(cloth, part, x));
      else if (frame == 0)
        write_obj(out / (part.name + ".obj"), part_mesh(cloth, part, x));
      if (cache) cache->add_sample(std::span(x).subspan(part.first_node, part.node_count));
    }
    if (cache) cache->finish();
  }
  fmt::print("{} frames of {} cloths written to {}\n", frames, cloth.parts().size(), out.string());
  return 0;
}

}  // namespace

void add_export_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand("export", "Convert the frames of a simulation for other programs");
  auto arguments = std::make_shared<ExportArguments>();
  verb->add_option("DIR", arguments->folder, "Results folder of `taut run`")->required();
  verb->add_option("--format", arguments->format, "obj: a file a frame and cloth; pc2: a mesh and a point cache a cloth")
      ->required()
      ->check(CLI::IsMember({"obj", "pc2"}));
  verb->add_option("--out", arguments->out, "Folder to write to (default: DIR/FORMAT)");
  verb->footer("Example: taut export out/ball --format pc2");
  verb->callback([arguments, &exit_code] { exit_code = export_frames(*arguments); });
}

}  // namespace taut::app
