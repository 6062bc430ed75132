#pragma once
// Solids as meshes, for pictures and export.

#include "taut/contact/solid.h"
#include "taut/picture/solid_mesh.h"

namespace taut {

// Where the solid is at `time` (s). A plane, which has no end, becomes a disc of 3 m radius about its own origin. `segments`: corners
// around a circle.
SolidMesh mesh_of(const Solid& solid, double time, int segments = 96);

// Is the pose ever another than at time 0?
bool moves(const Solid& solid);

}  // namespace taut
