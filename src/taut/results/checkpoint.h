#pragma once
// Everything needed to go on with a simulation to the same bits, as one binary file
// (little-endian):
//
//   "TAUTCKP5", then the scene as TOML (length, bytes), steps done, frame, time,
//   has_previous, the arrays x, v, x_prev, v_prev, last (length, doubles), the contacts, the
//   solver's memory, the nodes of rigid zones, what pushed the surface's pairs, sums of the mesh
//   and motion files, and a checksum (FNV-1a, 64 bits) of all before it

#include <iosfwd>
#include <string>

#include "taut/contact/cloth_contact.h"
#include "taut/contact/solid_contact.h"
#include "taut/step/state.h"

namespace taut {

struct Checkpoint {
  std::string scene;  // TOML, all defaults filled in
  int steps = 0;
  int frame = 0;
  State state;
  ContactState contacts;
  std::vector<double> solver_memory;  // ConstrainedSolver::memory
  ClothContactState surface_contact;
  // sums of what mesh and motion files held (Simulation::input_files)
  std::vector<std::uint64_t> files;
};

void write(std::ostream& out, const Checkpoint& checkpoint);
// `name` stands in messages. Throws InputError on anything but a complete checkpoint of this
// version.
Checkpoint parse_checkpoint(const std::string& bytes, const std::string& name);

}  // namespace taut
