#pragma once
// Solids as meshes, for pictures and export.

#include <map>

#include "taut/contact/solid.h"
#include "taut/picture/solid_mesh.h"
#include "taut/scene/mesh_solid.h"
#include "taut/scene/scene.h"

namespace taut {

// Where the solid is at `time` (s). A plane, which has no end, becomes a disc of 3 m radius about its own origin. `segments`: corners
// around a circle.
// Nothing for a solid that is a mesh in a file: see MeshSolid.
SolidMesh mesh_of(const Solid& solid, double time, int segments = 96);
// With normals at the vertices that are means over their triangles.
SolidMesh mesh_of(const MeshSolid& solid, double time);

// All solids of a scene, whatever their shape. Throws InputError as MeshSolid.
class SolidShapes {
 public:
  explicit SolidShapes(const Scene& scene);
  std::size_t count() const { return solids_.size(); }
  SolidMesh at(std::size_t solid, double time, int segments = 96) const;

 private:
  std::vector<Solid> solids_;
  std::map<std::size_t, MeshSolid> meshes_;
};

// Is its pose or its shape ever another than at time 0?
bool moves(const Solid& solid);

}  // namespace taut
