#pragma once
// Options of contact. Ranges: sim/describe_contact.cpp.

#include <string>
#include <vector>

namespace taut {

// Two bodies that have another thickness or friction with each other than they have otherwise, by
// name: a cloth, and a cloth (itself, too) or a solid.
struct ContactPair {
  std::string cloth, with;
  // m, between the middles of two layers, or from the solid's surface; negative: as otherwise
  double thickness = -1.0;
  double friction = -1.0;  // Coulomb's mu; negative: as otherwise
  bool operator==(const ContactPair&) const = default;
};

struct ContactOptions {
  // Solves per step, at most, until the set of contacts and their stick or slide no longer changes.
  // What still penetrates then is moved out.
  int max_passes = 8;
  // A node this close (m) to a solid's (thickened) surface touches it.
  double touch_tolerance = 1e-6;

  // Cloth with itself, with other cloths and with mesh solids (contact/cloth_contact.h).
  bool self = true;
  double thickness = 0.0;  // m, between the middles of two layers; 0: chosen from the cloths' edges
  double friction = 0.3;   // Coulomb's mu of cloth on cloth
  int sweeps = 8;          // rounds of impulses before what is left is held as rigid zones
  int check_every = 1;     // steps from one exact check for intersections to the next; 0: none
  bool allow_intersections = false;  // start although there are intersections
  // draw cloth that intersects at the start apart (contact/untangle.h)
  bool untangle = false;
  std::vector<ContactPair> pairs{};  // no two of the same bodies
  bool operator==(const ContactOptions&) const = default;
};

}  // namespace taut
