#include "taut/scene/schema.h"

#include <fmt/format.h>

#include "taut/scene/schema_parts.h"

namespace taut {

namespace {

void describe_time(SchemaVisitor& v, TimeOptions& time) {
  describe_step(v, time.step);
  v.integer(
      "frames", time.frames,
      {.doc = "pictures written after the first, which shows the start", .min = 1, .max = 1e6});
  v.integer("steps_per_frame", time.steps_per_frame,
            {.doc = "time steps from picture to picture", .min = 1, .max = 1e6});
  v.check(static_cast<double>(time.frames) * time.steps_per_frame <= 2e9, "steps_per_frame",
          fmt::format("{} frames of {} steps are more than 2e9 steps", time.frames,
                      time.steps_per_frame));
  describe_integration(v, time.integrator, time.newton, time.overshoot_limit, time.max_halvings);
}

// Entries without a name get "cloth_0", "cloth_1", ...
template <class Named>
std::vector<std::string> name_all(SchemaVisitor& v, const char* key, std::vector<Named>& items) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name.empty()) items[i].name = fmt::format("{}_{}", key, i);
    names.push_back(items[i].name);
  }
  check_names(v, key, names);
  return names;
}

}  // namespace

void describe(SchemaVisitor& v, Scene& scene) {
  v.text("title", scene.title,
         {.doc = "one line, shown in reports and pictures", .unset = scene.title.empty()});
  describe_gravity(v, scene.gravity);
  v.table("time", {.doc = "Time steps and pictures."}, [&] { describe_time(v, scene.time); });
  v.table("solver", {.doc = "The linear solver."}, [&] { describe_solver(v, scene.solver); });
  v.table("contact", {.doc = "Contact of cloth with solids, other cloth and itself."},
          [&] { describe_contact(v, scene.contact); });
  v.table("wind", {.doc = "Air that moves."}, [&] { describe_wind(v, scene.wind); });
  v.list("cloth", scene.cloths,
         {.doc = "A piece of cloth; a scene has at least one.", .required = true},
         [&](Cloth& cloth) { describe_cloth(v, cloth); });
  v.list("solid", scene.solids, {.doc = "A solid that cloth collides with, still or moving."},
         [&](SolidEntry& solid) { describe_solid(v, solid); });
  const std::vector<std::string> cloths = name_all(v, "cloth", scene.cloths),
                                 solids = name_all(v, "solid", scene.solids);
  check_pairs(v, scene.contact.pairs, cloths, solids);
}

}  // namespace taut
