#pragma once
// The inner loops of the broad phase: which of eight boxes overlap which of eight
// others. Private to contact.
//
//   mine, theirs   two groups
//   lanes          of mine that are looked at
//   masks[l]       for these: the lanes of theirs whose boxes may overlap that of lane l at some
//                  time (`overlapping`); other entries are left alone
//   still          only the boxes at the start are there

#include "taut/contact/detection/box_tree.h"

namespace taut::detail {

// Of all eight lanes of mine.
void group_overlaps(const BoxGroup& mine, const BoxGroup& theirs, bool still, std::uint8_t* masks);

// Of leaves, without items that have a corner in common. parent, lane: where the box around theirs
// is. Returns those of the lanes that this box overlaps: only for them masks are set. For items
// with `my_corners` and `their_corners` corners: 1 and 3, 2 and 2, 2 and 3.
template <int my_corners, int their_corners>
Mask leaf_overlaps(const LeafGroup& mine, const LeafGroup& theirs, const BoxGroup& parent, int lane,
                   Mask lanes, bool still, std::uint8_t* masks);

}  // namespace taut::detail
