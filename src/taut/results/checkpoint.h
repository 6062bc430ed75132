#pragma once
// Everything needed to go on with a run to the same bits, as one binary file (little-endian):
//
//   "TAUTCKP6", the scene as TOML (length, bytes), the frame, sums of the mesh and motion files,
//   the simulation's snapshot (sim/snapshot.h; length, bytes), an FNV-1a sum of all before it

#include <iosfwd>
#include <string>
#include <vector>

#include "taut/sim/snapshot.h"

namespace taut {

struct Checkpoint {
  std::string scene;  // TOML, all defaults filled in
  int frame = 0;
  // sums of what mesh and motion files held (SceneSimulation::input_files)
  std::vector<std::uint64_t> files;
  Snapshot snapshot;
};

void write(std::ostream& out, const Checkpoint& checkpoint);
// `name` stands in messages. Throws InputError on anything but a complete checkpoint of this
// version.
Checkpoint parse_checkpoint(const std::string& bytes, const std::string& name);

}  // namespace taut
