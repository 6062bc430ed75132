#include <fmt/format.h>

#include "counted.h"
#include "taut/base/error.h"
#include "taut/io/obj.h"
#include "taut/scene/scene_file.h"
#include "taut/scene/scene_simulation.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/surface_contact.h"
#include "verbs.h"

namespace taut::app {

namespace {

// Not over what the scene is made of: a start drawn apart would become the cloth's rest shape.
void refuse_own_mesh(const Scene& scene, const std::filesystem::path& out) {
  std::error_code none;
  const auto refuse = [&](const std::filesystem::path& mesh, const std::string& whose) {
    if (!mesh.empty() && std::filesystem::equivalent(mesh, out, none))
      throw InputError(
          {out.string()},
          fmt::format("is the mesh of {} itself; give another file with --out", whose));
  };
  for (const Cloth& cloth : scene.cloths) refuse(cloth.mesh, "cloth '" + cloth.name + "'");
  for (const SolidEntry& solid : scene.solids) refuse(solid.mesh, "solid '" + solid.name + "'");
}

// Where cloths start, an OBJ each: FILE.obj, or FILE_NAME.obj of several.
void write_start(const Scene& scene, const ClothModel& cloth, const std::filesystem::path& out) {
  for (const ClothPart& part : cloth.parts()) {
    TriangleMesh mesh;
    const auto nodes =
        std::span(cloth.surface().positions).subspan(part.first_node, part.node_count);
    mesh.positions.assign(nodes.begin(), nodes.end());
    const auto uv = std::span(cloth.surface().texcoords).subspan(part.first_node, part.node_count);
    mesh.texcoords.assign(uv.begin(), uv.end());
    for (const Triangle& t :
         std::span(cloth.surface().triangles).subspan(part.first_triangle, part.triangle_count))
      mesh.triangles.push_back(
          {t[0] - part.first_node, t[1] - part.first_node, t[2] - part.first_node});
    std::filesystem::path file = out;
    if (cloth.parts().size() > 1)
      file.replace_filename(out.stem().string() + "_" + part.name + ".obj");
    refuse_own_mesh(scene, file);
    write_obj(file, mesh);
    fmt::print("start of cloth '{}': {}\n", part.name, file.string());
  }
}

void say_untangled(const SceneSimulation& simulation, const std::string& path,
                   const std::string& out) {
  const UntangleReport* report =
      simulation.surface_contact() ? simulation.surface_contact()->untangled() : nullptr;
  if (!report) {
    fmt::print("nothing is untangled where contact.self is off and no solid is a mesh\n");
    return;
  }
  fmt::print("{}\n", describe(*report));
  if (report->moved == 0) return;
  if (out.empty())
    fmt::print(
        "`taut check {0} --untangle --out FILE.obj` writes that start; `taut run {0} --untangle` "
        "runs from it\n",
        path);
}

int check(const std::string& path, std::vector<std::string> settings, bool untangle,
          const std::string& out) {
  if (untangle) settings.push_back("contact.untangle=true");
  Scene scene = read_scene(path, settings);
  const std::vector<std::string> doubts = doubtful(scene);
  // Building the model reads the meshes and finds what the file alone cannot show.
  const SceneSimulation simulation(std::move(scene));
  const ClothModel& cloth = simulation.cloth();
  std::size_t springs = 0;
  for (const auto& model : cloth.springs()) springs += model->springs().size();
  const TimeOptions& time = simulation.scene().time;
  fmt::print("{}: no errors: {}, {}, {}, {}, {}\n", path, counted(cloth.parts().size(), "cloth"),
             counted(cloth.nodes(), "node"), counted(springs, "spring"),
             counted(simulation.scene().solids.size(), "solid"),
             counted(time.frames * time.steps_per_frame, "step"));
  if (simulation.scene().contact.untangle) say_untangled(simulation, path, out);
  if (!out.empty()) write_start(simulation.scene(), cloth, out);
  for (const std::string& doubt : doubts) fmt::print("doubtful: {}\n", doubt);
  return 0;
}

CLI::Validator obj_file() {
  return {[](const std::string& text) {
            return std::filesystem::path(text).extension() == ".obj"
                       ? std::string()
                       : "'" + text +
                             "' is no FILE.obj; the start is written as OBJ: give a name that ends "
                             "in .obj";
          },
          ""};
}

}  // namespace

void add_check_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand(
      "check", "Say what is wrong or doubtful in a scene, and how to mend it; simulate nothing");
  auto scene = std::make_shared<std::string>();
  auto settings = std::make_shared<std::vector<std::string>>();
  verb->add_option("SCENE", *scene, "Scene file (TOML)")->required();
  verb->add_option("--set", *settings, "Change a key of the scene: key=value; may be repeated")
      ->take_all()
      ->type_name("KEY=VALUE");
  auto untangle = std::make_shared<bool>(false);
  verb->add_flag("--untangle", *untangle,
                 "Draw cloth that intersects at the start, or is inside a solid, apart, and say "
                 "what that moved");
  auto out = std::make_shared<std::string>();
  verb->add_option("--out", *out,
                   "Write where the cloth starts, after --untangle if that is given, as OBJ (of "
                   "several cloths: FILE_NAME.obj)")
      ->type_name("FILE.obj")
      ->check(obj_file());
  verb->footer(
      "Example: taut check scenes/ball.toml\nExit code 1 when the scene has errors; doubts do not "
      "count.");
  verb->callback([=, &exit_code] { exit_code = check(*scene, *settings, *untangle, *out); });
}

}  // namespace taut::app
