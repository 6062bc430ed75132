#pragma once
// Positions of a mesh's vertices over time.
//
//   NAME.pc2          point cache (io/pc2.h)
//   NAME.f32, .raw    little-endian float32, samples x vertices x 3, nothing else: the number of
//                     samples follows from the size
//   NAME0001.obj      the first of OBJ files that differ in the number before .obj: all that exist
//                     without a gap, their vertices in order
//
// Throws InputError naming the file when it cannot be read, its size does not fit the number of
// vertices, or a number is not finite.

#include <filesystem>
#include <vector>

#include "taut/base/types.h"

namespace taut {

// samples, each with `vertices` positions as they stand in the file.
std::vector<std::vector<Vec3>> read_motion(const std::filesystem::path& path, Index vertices);

}  // namespace taut
