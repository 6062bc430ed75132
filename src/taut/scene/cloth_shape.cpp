#include "taut/scene/cloth_shape.h"

#include "taut/io/obj.h"

namespace taut {

TriangleMesh start_shape(const Cloth& cloth) {
  if (!cloth.from_file) return make_grid(cloth.grid);
  TriangleMesh mesh = read_obj(cloth.mesh);
  for (Vec3& x : mesh.positions) {
    x *= cloth.scale;
    if (cloth.y_up) x = Vec3(x.x(), -x.z(), x.y());
    x = cloth.placement.to_world(x);
  }
  return mesh;
}

}  // namespace taut
