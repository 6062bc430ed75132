#pragma once
// Options of contact with solids; validated by scene/.

namespace taut {

struct ContactOptions {
  // Solves per step, at most, until the set of contacts and their stick or slide no longer changes. What still penetrates then is moved out.
  int max_passes = 8;
  // A node this close (m) to a solid's (thickened) surface touches it.
  double touch_tolerance = 1e-6;
  bool operator==(const ContactOptions&) const = default;
};

}  // namespace taut
