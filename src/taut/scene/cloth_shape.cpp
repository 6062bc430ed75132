#include "taut/scene/cloth_shape.h"

#include "taut/io/mesh_file.h"
#include "taut/mesh/topology.h"

namespace taut {

TriangleMesh rest_shape(const Cloth& cloth, const std::filesystem::path& folder) {
  if (cloth.is_tube) return make_tube(cloth.tube);
  if (!cloth.from_file) return make_grid(cloth.grid);
  const std::filesystem::path path = cloth.mesh.is_absolute() ? cloth.mesh : folder / cloth.mesh;
  TriangleMesh mesh = read_mesh(path, cloth.prim);
  check_cloth_mesh(mesh, path.string());
  for (Vec3& x : mesh.positions) {
    if (cloth.y_up) x = Vec3(x.x(), -x.z(), x.y());
    x *= cloth.scale;
  }
  return mesh;
}

TriangleMesh start_shape(const Cloth& cloth, const std::filesystem::path& folder) {
  TriangleMesh mesh = rest_shape(cloth, folder);
  for (Vec3& x : mesh.positions) x = cloth.placement.to_world(x);
  return mesh;
}

}  // namespace taut
