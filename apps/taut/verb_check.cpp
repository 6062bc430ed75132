#include <fmt/format.h>

#include "taut/scene/scene_file.h"
#include "taut/scene/simulation.h"
#include "verbs.h"

namespace taut::app {

namespace {

int check(const std::string& path, const std::vector<std::string>& settings) {
  Scene scene = read_scene(path, settings);
  const std::vector<std::string> doubts = doubtful(scene);
  // Building the model reads the meshes and finds what the file alone cannot show.
  const Simulation simulation(std::move(scene));
  const ClothModel& cloth = simulation.cloth();
  std::size_t springs = 0;
  for (const auto& model : cloth.springs()) springs += model->springs().size();
  fmt::print("{}: no errors: {} cloths, {} nodes, {} springs, {} solids, {} steps\n", path, cloth.parts().size(), cloth.nodes(), springs,
             simulation.scene().solids.size(), simulation.scene().time.frames * simulation.scene().time.steps_per_frame);
  for (const std::string& doubt : doubts) fmt::print("doubtful: {}\n", doubt);
  return 0;
}

}  // namespace

void add_check_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand("check", "Say what is wrong or doubtful in a scene, and how to mend it; simulate nothing");
  auto scene = std::make_shared<std::string>();
  auto settings = std::make_shared<std::vector<std::string>>();
  verb->add_option("SCENE", *scene, "Scene file (TOML)")->required();
  verb->add_option("--set", *settings, "Change a key of the scene: key=value; may be repeated")->take_all()->type_name("KEY=VALUE");
  verb->footer("Example: taut check scenes/ball.toml\nExit code 1 when the scene has errors; doubts do not count.");
  verb->callback([=, &exit_code] { exit_code = check(*scene, *settings); });
}

}  // namespace taut::app
