#include <array>

#include "taut/sim/describe.h"

namespace taut {

namespace {
constexpr std::array shape_names{"sphere", "plane", "cylinder", "box", "mesh"};
}  // namespace

void describe_solid_shape(SchemaVisitor& v, Solid& solid) {
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
}

void describe_solid_motion(SchemaVisitor& v, Solid& solid) {
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

void describe_pose(SchemaVisitor& v, Pose& pose, bool applies, const char* only_for) {
  v.vector("translation", pose.translation,
           {.doc = "moved by this, after the rotation",
            .unit = "m",
            .min = -1e6,
            .max = 1e6,
            .applies = applies,
            .only_for = only_for});
  v.rotation("rotation", pose.rotation,
             {.doc = "turned about the origin", .applies = applies, .only_for = only_for});
}

void describe_key_frames(SchemaVisitor& v, std::vector<KeyFrame>& frames, const char* doc) {
  v.list("key_frames", frames, {.doc = doc}, [&](KeyFrame& frame) {
    v.number("time", frame.time,
             {.doc = "when", .unit = "s", .min = -1e6, .max = 1e6, .required = true});
    describe_pose(v, frame.pose, true, "");
  });
  for (std::size_t i = 1; i < frames.size(); ++i)
    v.check(frames[i - 1].time < frames[i].time, "key_frames",
            "times must ascend, but number " + std::to_string(i) +
                " (from 0) is not later than the one before it: sort the key frames by time");
}

void describe_pin_path(SchemaVisitor& v, Vec3& pivot, double& release,
                       std::vector<KeyFrame>& frames) {
  v.vector("pivot", pivot, {.doc = "the point about which the key frames turn", .unit = "m"});
  v.number("release", release,
           {.doc = "when the nodes are let go; never when not given",
            .unit = "s",
            .min = 0,
            .max = 1e6,
            .unset = release < 0});
  describe_key_frames(
      v, frames,
      "A path: the nodes are carried by its displacement since time 0, linear in between.");
}

}  // namespace taut
