#pragma once
// All that the steps to come depend on, beside the World and the SimulationOptions: a simulation of
// the same world and options that loads it goes on to the same bits, for any number of threads.
//
//   const Snapshot before = simulation.save();
//   ...
//   simulation.load(before);     or that of another Simulation, in another thread or process
//
// It is bytes, to be stored as they are, and equal where the simulations go on alike. load()
// refuses (InputError) what is damaged, of another version of Taut or of another world.

#include <string>

namespace taut {

struct Snapshot {
  std::string bytes;
  bool operator==(const Snapshot&) const = default;
};

}  // namespace taut
