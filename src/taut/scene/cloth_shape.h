#pragma once
// The shape of a cloth, before anything has moved.

#include <filesystem>

#include "taut/mesh/triangle_mesh.h"
#include "taut/scene/scene.h"

namespace taut {

// At rest, m: a grid as make_grid; a mesh as its file, looked for in `folder` if its path is
// relative, turned from Y-up to Z-up ((x, y, z) becomes (x, -z, y)) if the scene says so, and
// scaled. Throws InputError as read_mesh and check_cloth_mesh.
TriangleMesh rest_shape(const Cloth& cloth, const std::filesystem::path& folder);
// The same where the scene places it; without jitter.
TriangleMesh start_shape(const Cloth& cloth, const std::filesystem::path& folder);

}  // namespace taut
