#pragma once
// Rows for pairs that are closer than their thickness at the start of a step: they do not
// come nearer along the direction of their closest points, and part by `parting_share` of
// what is missing. Bridson et al. 2002, section 7.2, has an inelastic impulse and a spring
// limited to a tenth of the overlap a step; as one condition on positions the two cannot
// work against each other.
//
// A row pushes along the line through its closest points: it keeps angular momentum, too.

#include "taut/contact/pair_search.h"

namespace taut {

// Of the thickness: how much further apart than at the start pairs need to end.
inline constexpr double parting_share = 0.2;

ContactRow repulsion_row(const NearPair& near, double thickness, double friction);

}  // namespace taut
