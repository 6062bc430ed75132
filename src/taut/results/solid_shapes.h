#pragma once
// The scene's solids as meshes over time, for pictures and export.

#include <map>

#include "taut/picture/solid_mesh.h"
#include "taut/scene/scene_world.h"
#include "taut/sim/mesh_solid.h"

namespace taut {

class SolidShapes {
 public:
  // `segments`: corners around a circle. A plane, which has no end, becomes a disc of 3 m radius
  // about its own origin. Reads the files of solids that are meshes; throws InputError as
  // MeshSolid.
  explicit SolidShapes(const Scene& scene, int segments = 96);

  std::size_t size() const { return scene_.solids.size(); }
  const SolidEntry& solid(std::size_t k) const { return scene_.solids[k]; }
  // Its name in the scene, or solid_K.
  std::string name(std::size_t k) const;
  // Is the shape ever another than at time 0?
  bool moves(std::size_t k) const;
  // At this time (s).
  SolidMesh at(std::size_t k, double time) const;

 private:
  const Scene& scene_;
  int segments_;
  std::map<std::size_t, MeshSolid> meshes_;  // by solid
};

}  // namespace taut
