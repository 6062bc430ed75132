#pragma once
// The nodes of one pin, and where they should be.
//
//   with key frames   the path's displacement since time 0 is added to where they started
//   moved by hand     the program says where they are at the end of the next step; until then they
//                     go there in a straight line, at constant speed

#include "taut/contact/solid.h"
#include "taut/sim/world.h"

namespace taut {

struct PinnedNodes {
  std::vector<Index> nodes;  // of the system
  std::vector<Vec3> start;   // m, where they were when they were pinned
  Solid carrier;             // carries the path's key frames
  Vec3 pivot = Vec3::Zero();
  double release = -1.0;  // s; negative: never
  bool held = true;       // false: let go by the program
  // Moved by hand, m; empty: not. From time t0 to t1, s, then they stay.
  std::vector<Vec3> from, to;
  double t0 = 0.0, t1 = 0.0;
  bool awaits_step = false;

  // Where node k should be at this time, m.
  Vec3 target(std::size_t k, double time) const;
  bool holds(double time) const { return held && (release < 0.0 || time < release); }
  // From `now` on by hand: to these places at the end of the next step, whose length begin_step
  // says.
  void move_to(std::vector<Vec3> places, double now);
  // The step that begins at this time has length h.
  void begin_step(double time, double h);
  void end_step() { awaits_step = false; }
};

}  // namespace taut
