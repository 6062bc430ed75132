// A program outside Taut that runs a scene file.
#include <cstdio>

#include "taut/scene/scene_file.h"
#include "taut/scene/scene_simulation.h"

int main(int, char** arguments) {
  taut::SceneSimulation simulation(taut::read_scene(arguments[1]));
  for (int k = 0; k < 3; ++k)
    if (const taut::StepReport report = simulation.step(); !report.ok())
      return std::puts(report.message().c_str()), 1;
  std::printf("%d steps of %s\n", simulation.steps_done(), simulation.scene().title.c_str());
}
