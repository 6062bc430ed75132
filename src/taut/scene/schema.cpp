#include "taut/scene/schema.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "taut/base/error.h"
#include "taut/scene/schema_parts.h"
#include "taut/solve/solver.h"

namespace taut {

namespace {

constexpr std::array integrator_names{"semi_implicit_euler", "imex", "imex_adaptive", "bdf2",
                                      "newton"};
constexpr std::array core_names{"stretch", "auto"};
constexpr std::array reordering_names{"vectors", "matrix"};

void describe_time(SchemaVisitor& v, TimeOptions& time) {
  v.number("step", time.step,
           {.doc = "time step h",
            .unit = "s",
            .min = 1e-7,
            .max = 0.1,
            .hint = "it is in seconds: 5 ms is 5e-3"});
  v.integer(
      "frames", time.frames,
      {.doc = "pictures written after the first, which shows the start", .min = 1, .max = 1e6});
  v.integer("steps_per_frame", time.steps_per_frame,
            {.doc = "time steps from picture to picture", .min = 1, .max = 1e6});
  v.check(static_cast<double>(time.frames) * time.steps_per_frame <= 2e9, "steps_per_frame",
          fmt::format("{} frames of {} steps are more than 2e9 steps", time.frames,
                      time.steps_per_frame));
  v.choice("integrator", time.integrator, integrator_names,
           {.doc = "`imex` treats stretch springs implicitly and all else explicitly: cheaper, but "
                   "bounded in step size by shear and "
                   "bending; `imex_adaptive` treats explicitly only those shear and bending "
                   "springs that are weak enough for the step; "
                   "`newton` is implicit Euler with the forces at the end of the step, iterated "
                   "until they hold"});
  v.number("newton_tolerance", time.newton.tolerance,
           {.doc = "`newton` stops when what is left of the momentum equation is below this share "
                   "of what drives the step",
            .min = 1e-12,
            .max = 0.5});
  v.integer("newton_max_iterations", time.newton.max_iterations,
            {.doc = "linear solves of `newton`; a step that needs more is halved",
             .min = 1,
             .max = 10000});
  v.number("overshoot_limit", time.overshoot_limit,
           {.doc = "a step in which a stretch spring ends longer than its linearised force "
                   "foresaw, by more than this share of its rest "
                   "length, is redone as "
                   "two halves",
            .min = 0,
            .max = 1e6});
  v.integer("max_halvings", time.max_halvings,
            {.doc = "a step is halved at most this often, because of `overshoot_limit` or because "
                    "it could not be solved; 0: every step "
                    "has length `step`, as in "
                    "the paper",
             .min = 0,
             .max = 20});
}

std::string unknown_solver(const std::string& name) {
  const std::vector<std::string> known = solver_names();
  const std::string near = nearest_name(name, known);
  return fmt::format("\"{}\" is not known: expected one of {}{}", name, fmt::join(known, ", "),
                     near.empty() ? "" : "; did you mean '" + near + "'?");
}

KeyInfo core_info(bool unset) {
  return {.doc =
              "which springs make the matrix core: `stretch`, as in the paper, or `auto`, those "
              "whose strength would cost iterations, of any "
              "class; when not given: `auto` for the solver `auto`, `stretch` for all others",
          .unset = unset};
}

void describe_solver(SchemaVisitor& v, SolverOptions& solver) {
  v.text("name", solver.name,
         {.doc = "METHOD or METHOD:PRECONDITIONER, as `--solver`; `core_pcg` is the paper's"});
  if (!is_solver_name(solver.name)) v.check(false, "name", unknown_solver(solver.name));
  v.number("tolerance", solver.tolerance,
           {.doc = "stop when δ <= tolerance² δ0 (Ascher & Boxerman); smaller is more accurate",
            .min = 1e-14,
            .max = 0.5});
  v.integer("max_iterations", solver.max_iterations,
            {.doc = "0: ten times the number of unknowns, at least 1000", .min = 0, .max = 1e9});
  if (v.given("core", !solver.core.empty())) {
    int core = solver.core == core_names[1] ? 1 : 0;
    v.choose("core", core, core_names, core_info(false));
    solver.core = core_names[static_cast<std::size_t>(core)];
  } else {
    int none = 0;
    v.choose("core", none, core_names, core_info(true));
  }
  std::string& reordering = solver.reordering;
  int index = reordering == reordering_names[1] ? 1 : 0;
  v.choose("reordering", index, reordering_names,
           {.doc = "`core_pcg` permutes the `vectors` in each iteration, or the `matrix` and the "
                   "vectors once"});
  reordering = reordering_names[static_cast<std::size_t>(index)];
  v.flag("reuse_analysis", solver.reuse_analysis,
         {.doc = "direct factorisations keep ordering and symbolic work while the pattern is the "
                 "same; the paper analyses in every step"});
}

void describe_wind(SchemaVisitor& v, Wind& wind) {
  v.vector("velocity", wind.velocity,
           {.doc = "where the air moves; it acts through a cloth's `drag` and `wind_pressure`",
            .unit = "m/s"});
  v.number("gust", wind.gust,
           {.doc = "share of the velocity that comes and goes: velocity (1 + gust sin(2π "
                   "gust_frequency t))",
            .min = 0,
            .max = 10});
  v.number("gust_frequency", wind.gust_frequency,
           {.doc = "gusts in a second", .unit = "Hz", .min = 0, .max = 1000});
}

// Entries without a name get "cloth_0", "cloth_1", ...; two of the same name would overwrite each
// other's files.
template <class Named>
void name_all(SchemaVisitor& v, const char* key, std::vector<Named>& items) {
  for (std::size_t i = 0; i < items.size(); ++i)
    if (items[i].name.empty()) items[i].name = fmt::format("{}_{}", key, i);
  for (std::size_t i = 0; i < items.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      v.check(items[i].name != items[j].name, key,
              "two entries are named '" + items[i].name + "' (numbers " + std::to_string(j) +
                  " and " + std::to_string(i) + ", from 0): give each its own name");
}

}  // namespace

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

void describe(SchemaVisitor& v, Scene& scene) {
  v.text("title", scene.title,
         {.doc = "one line, shown in reports and pictures", .unset = scene.title.empty()});
  v.vector("gravity", scene.gravity,
           {.doc = "acceleration of everything; z is up", .unit = "m/s²"});
  v.table("time", {.doc = "Time steps and pictures."}, [&] { describe_time(v, scene.time); });
  v.table("solver", {.doc = "The linear solver."}, [&] { describe_solver(v, scene.solver); });
  v.table("contact", {.doc = "Contact of cloth with solids, other cloth and itself."},
          [&] { describe_contact(v, scene.contact); });
  v.table("wind", {.doc = "Air that moves."}, [&] { describe_wind(v, scene.wind); });
  v.list("cloth", scene.cloths,
         {.doc = "A piece of cloth; a scene has at least one.", .required = true},
         [&](Cloth& cloth) { describe_cloth(v, cloth); });
  v.list("solid", scene.solids, {.doc = "A solid that cloth collides with, still or moving."},
         [&](Solid& solid) { describe_solid(v, solid); });
  name_all(v, "cloth", scene.cloths);
  name_all(v, "solid", scene.solids);
  check_pairs(v, scene);
}

}  // namespace taut
