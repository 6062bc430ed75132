#include <array>

#include "taut/scene/schema_parts.h"

namespace taut {

namespace {
constexpr std::array mesh_up_names{"z", "y"};
}  // namespace

void describe_solid(SchemaVisitor& v, SolidEntry& solid) {
  describe_solid_shape(v, solid);
  const bool mesh = solid.shape == SolidShape::mesh;
  constexpr const char* mesh_only = "a mesh";
  v.file("mesh", solid.mesh,
         {.doc = "OBJ, PLY or USD file, relative to the scene file; closed or open, cloth stays on "
                 "the side where it starts",
          .required = true,
          .applies = mesh,
          .only_for = mesh_only});
  v.text("prim", solid.prim,
         {.doc = "which mesh of a USD file, by its path (`/World/Shirt`); not needed where there "
                 "is only one",
          .unset = solid.prim.empty(),
          .applies = mesh,
          .only_for = mesh_only});
  v.number("scale", solid.scale,
           {.doc = "of the files' lengths: 0.01 for centimetres",
            .min = 1e-6,
            .max = 1e6,
            .applies = mesh,
            .only_for = mesh_only});
  int up = solid.y_up ? 1 : 0;
  v.choose("up", up, mesh_up_names,
           {.doc = "the files' upward axis; `y` is turned to Taut's z",
            .applies = mesh,
            .only_for = mesh_only});
  solid.y_up = up == 1;
  v.file("motion", solid.motion,
         {.doc = "its vertices over time: PC2, raw float32 (.f32, .raw) or the first OBJ of a "
                 "numbered sequence; linear in between, the last held",
          .unset = solid.motion.empty(),
          .applies = mesh,
          .only_for = mesh_only});
  v.number("motion_rate", solid.motion_rate,
           {.doc = "samples of `motion` in a second",
            .unit = "Hz",
            .min = 1e-3,
            .max = 1e6,
            .applies = mesh,
            .only_for = mesh_only});
  describe_solid_motion(v, solid);
}

}  // namespace taut
