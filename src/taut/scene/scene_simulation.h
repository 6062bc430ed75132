#pragma once
// The simulation of a scene file: a Simulation that knows its scene and takes the scene's steps.

#include "taut/scene/scene_world.h"
#include "taut/sim/simulation.h"

namespace taut {

class SceneSimulation : public Simulation {
 public:
  // Throws InputError as make_world and Simulation.
  explicit SceneSimulation(Scene scene);

  const Scene& scene() const { return scene_; }
  // The mesh and motion files that were read, and what was in them.
  std::span<const InputFile> input_files() const { return files_; }

  using Simulation::step;
  // One of the scene's steps.
  StepReport step() { return step(scene_.time.step); }
  Status step(StepReport& report) { return (report = step()).status; }

 private:
  SceneSimulation(Scene scene, SceneWorld world);

  Scene scene_;
  std::vector<InputFile> files_;
};

}  // namespace taut
