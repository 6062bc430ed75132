#pragma once
// The second half of untangle.h: from a state without intersections to one with room
// between layers and with the lengths of edges restored, by rounds of contact's own
// response, which never lets it get any.

#include "taut/contact/edge_lengths.h"
#include "taut/contact/untangle.h"

namespace taut {

struct SettledQuality {
  double gap = 0.0;     // m: least distance of two features, at most the thickness
  double excess = 0.0;  // share by which edges are outside their ranges, at most
};

// Until layers are half a thickness apart and lengths within their ranges, for at most
// options.most_rounds, or until the response fails. x is then as after the last round that did not.
// rounds: how many there were.
SettledQuality settle(const UntangleInput& input, std::span<const LengthRange> ranges,
                      const UntangleOptions& options, std::span<Vec3> x, int& rounds);

}  // namespace taut
