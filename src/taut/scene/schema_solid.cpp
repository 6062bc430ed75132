#include <array>

#include "taut/scene/schema_parts.h"

namespace taut {

namespace {
constexpr std::array mesh_up_names{"z", "y"};
constexpr std::array shape_names{"sphere", "plane", "cylinder", "box", "mesh"};
}  // namespace

void describe_solid(SchemaVisitor& v, Solid& solid) {
  v.text("name", solid.name,
         {.doc = "for reports; `solid_0`, `solid_1`, ... when not given",
          .unset = solid.name.empty()});
  v.choice("shape", solid.shape, shape_names,
           {.doc = "sphere: centre at the origin; plane: solid below, normal +z; cylinder: axis z, "
                   "flat caps; box: edges along the axes; all "
                   "centred, then moved by `translation` and `rotation`",
            .required = true});
  const bool sphere = solid.shape == SolidShape::sphere;
  const bool cylinder = solid.shape == SolidShape::cylinder, box = solid.shape == SolidShape::box;
  v.number("radius", solid.radius,
           {.doc = "radius",
            .unit = "m",
            .min = 0,
            .max = 1e6,
            .above_min = true,
            .required = true,
            .applies = sphere || cylinder,
            .only_for = "a sphere or a cylinder"});
  v.number("height", solid.height,
           {.doc = "from cap to cap",
            .unit = "m",
            .min = 0,
            .max = 1e6,
            .above_min = true,
            .required = true,
            .applies = cylinder,
            .only_for = "a cylinder"});
  v.vector("size", solid.size,
           {.doc = "edge lengths along x, y, z",
            .unit = "m",
            .min = 0,
            .max = 1e6,
            .above_min = true,
            .required = true,
            .applies = box,
            .only_for = "a box"});
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
  v.number("friction", solid.friction,
           {.doc = "Coulomb's μ, at rest and sliding", .min = 0, .max = 100});
  v.number(
      "thickness", solid.thickness,
      {.doc = "cloth is kept this far from the surface; a little hides that triangles cut corners",
       .unit = "m",
       .min = 0,
       .max = 1});
  const bool constant = !v.given("key_frames", !solid.key_frames.empty());
  constexpr const char* without_key_frames = "a solid without key_frames";
  describe_pose(v, solid.initial, constant, without_key_frames);
  v.vector("velocity", solid.velocity,
           {.doc = "constant", .unit = "m/s", .applies = constant, .only_for = without_key_frames});
  v.vector("angular_velocity", solid.angular_velocity,
           {.doc = "constant, about the solid's own origin, world axes",
            .unit = "rad/s",
            .applies = constant,
            .only_for = without_key_frames});
  describe_key_frames(v, solid.key_frames,
                      "Where the solid is at some times, instead of `translation`, `rotation` and "
                      "velocities: linear in between, held before "
                      "the first and after the last.");
}

}  // namespace taut
