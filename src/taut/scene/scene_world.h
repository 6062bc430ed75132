#pragma once
// The World of a scene: meshes read, nodes of pins found, cloths placed and jittered.

#include <filesystem>
#include <vector>

#include "taut/scene/scene.h"
#include "taut/sim/simulation_options.h"
#include "taut/sim/world.h"

namespace taut {

// A mesh or motion that was read, and a sum of what was in it (base/checksum.h).
struct InputFile {
  std::filesystem::path path;
  std::uint64_t sum = 0;
};

struct SceneWorld {
  World world;
  std::vector<InputFile> files;  // of cloths, then of solids
};

// Throws InputError: what describe() finds wrong in a scene that a program has made, unreadable or
// faulty meshes, pins of nodes that do not exist; with the place in the scene file where there is
// one.
SceneWorld make_world(const Scene& scene);
SimulationOptions simulation_options(const Scene& scene);

// A mesh solid's files, scaled and turned to Taut's z. `files` gets their sums, unless null.
SolidSurface read_surface(const SolidEntry& solid, const std::filesystem::path& folder,
                          std::vector<InputFile>* files = nullptr);

// The cloth's nodes that a pin holds, ascending, each once. Throws InputError for a corner or edge
// that there is not.
std::vector<Index> selected_nodes(const Cloth& cloth, const NodeSelection& where);

}  // namespace taut
