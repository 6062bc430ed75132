#pragma once
// The innermost loop of the broad phase: which of eight items overlap which of eight others. Private to contact.
//
//   mine, theirs         boxes of the two groups, and the corners of their items: one CornerGroup each a corner
//   lanes                of mine that are looked at
//   masks[l]             for these: the lanes of theirs whose boxes may overlap that of lane l at some time (`overlapping`), and whose
//   items
//                        have no corner in common with its item; other entries are left alone
//   still                only the boxes at the start are there

#include "taut/contact/detection/box_tree.h"

namespace taut::detail {

// For items with `my_corners` and `their_corners` corners: 1 and 3, 2 and 2, 2 and 3.
template <int my_corners, int their_corners>
void leaf_overlaps(const LeafGroup& mine, const LeafGroup& theirs, Mask lanes, bool still, std::uint8_t* masks);

}  // namespace taut::detail
