#include "taut/scene/scene_simulation.h"

namespace taut {

SceneSimulation::SceneSimulation(Scene scene) : SceneSimulation(scene, make_world(scene)) {}

SceneSimulation::SceneSimulation(Scene scene, SceneWorld world)
    : Simulation(std::move(world.world), simulation_options(scene)),
      scene_(std::move(scene)),
      files_(std::move(world.files)) {
  prepare(scene_.time.step);
}

}  // namespace taut
