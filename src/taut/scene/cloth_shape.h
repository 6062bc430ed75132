#pragma once
// The shape in which a cloth starts.

#include "taut/mesh/triangle_mesh.h"
#include "taut/scene/scene.h"

namespace taut {

// A grid as make_grid; a mesh as its file, scaled, turned from Y-up to Z-up ((x, y, z) becomes (x, -z, y)), then placed. Without jitter.
// Throws InputError as read_obj.
TriangleMesh start_shape(const Cloth& cloth);

}  // namespace taut
