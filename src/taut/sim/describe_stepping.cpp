// Gravity, wind, the solver, the integrator.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "taut/sim/describe.h"
#include "taut/solve/solver.h"

namespace taut {

namespace {

constexpr std::array integrator_names{"semi_implicit_euler", "imex", "imex_adaptive", "bdf2",
                                      "newton"};
constexpr std::array core_names{"stretch", "auto"};
constexpr std::array reordering_names{"vectors", "matrix"};

std::string unknown_solver(const std::string& name) {
  const std::vector<std::string> known = solver_names();
  const std::string near = nearest_name(name, known);
  return fmt::format("\"{}\" is not known: expected one of {}{}", name, fmt::join(known, ", "),
                     near.empty() ? "" : "; did you mean '" + near + "'?");
}

// A program may have written anything there.
void check_word(SchemaVisitor& v, const char* key, const std::string& word,
                std::span<const char* const> names) {
  if (!word.empty() && std::ranges::find(names, word) == names.end())
    v.check(false, key, unknown_name(word, names).substr(2));
}

KeyInfo core_info(bool unset) {
  return {.doc =
              "which springs make the matrix core: `stretch`, as in the paper, or `auto`, those "
              "whose strength would cost iterations, of any "
              "class; when not given: `auto` for the solver `auto`, `stretch` for all others",
          .unset = unset};
}

}  // namespace

void describe_gravity(SchemaVisitor& v, Vec3& gravity) {
  v.vector("gravity", gravity, {.doc = "acceleration of everything; z is up", .unit = "m/s²"});
}

void describe_wind(SchemaVisitor& v, WindOptions& wind) {
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

void describe_solver(SchemaVisitor& v, SolverOptions& solver) {
  check_word(v, "core", solver.core, core_names);
  check_word(v, "reordering", solver.reordering, reordering_names);
  v.check(solver.ssor_omega > 0.0 && solver.ssor_omega < 2.0, "ssor_omega",
          fmt::format("{} found, a number above 0 and below 2 was expected", solver.ssor_omega));
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

void describe_step(SchemaVisitor& v, double& step) {
  v.number("step", step,
           {.doc = "time step h",
            .unit = "s",
            .min = 1e-7,
            .max = 0.1,
            .hint = "it is in seconds: 5 ms is 5e-3"});
}

void describe_integration(SchemaVisitor& v, IntegratorKind& integrator, NewtonOptions& newton,
                          double& overshoot_limit, int& max_halvings) {
  v.choice("integrator", integrator, integrator_names,
           {.doc = "`imex` treats stretch springs implicitly and all else explicitly: cheaper, but "
                   "bounded in step size by shear and "
                   "bending; `imex_adaptive` treats explicitly only those shear and bending "
                   "springs that are weak enough for the step; "
                   "`newton` is implicit Euler with the forces at the end of the step, iterated "
                   "until they hold"});
  v.number("newton_tolerance", newton.tolerance,
           {.doc = "`newton` stops when what is left of the momentum equation is below this share "
                   "of what drives the step",
            .min = 1e-12,
            .max = 0.5});
  v.integer("newton_max_iterations", newton.max_iterations,
            {.doc = "linear solves of `newton`; a step that needs more is halved",
             .min = 1,
             .max = 10000});
  v.number("overshoot_limit", overshoot_limit,
           {.doc = "a step in which a stretch spring ends longer than its linearised force "
                   "foresaw, by more than this share of its rest "
                   "length, is redone as "
                   "two halves",
            .min = 0,
            .max = 1e6});
  v.integer("max_halvings", max_halvings,
            {.doc = "a step is halved at most this often, because of `overshoot_limit` or because "
                    "it could not be solved; 0: every step "
                    "has length `step`, as in "
                    "the paper",
             .min = 0,
             .max = 20});
}

}  // namespace taut
