#include "taut/results/dump.h"

#include <fmt/format.h>

#include <algorithm>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/io/matrix_market.h"
#include "taut/results/dump_meta.h"
#include "taut/sim/cloth_model.h"
#include "taut/solve/linear_system.h"
#include "taut/solve/preconditioner_choice.h"
#include "taut/step/state.h"
#include "taut/step/stepper.h"

namespace taut {

namespace fs = std::filesystem;

namespace {

constexpr const char* dump_names[] = {
    "A.mtx",        "A_core.mtx",  "K_stretch.mtx", "K_shear.mtx", "K_bend.mtx", "D_external.mtx",
    "S.mtx",        "U.mtx",       "M.mtx",         "b.mtx",       "z.mtx",      "x.mtx",
    "v.mtx",        "f.mtx",       "dv.mtx",        "x_prev.mtx",  "v_prev.mtx", "guess.mtx",
    "friction.mtx", "springs.csv", "meta.json"};

// The blocks of A in the core, as a matrix of its own.
BlockCsr core_of(const BlockCsr& a, std::span<const std::uint8_t> core) {
  const BlockPattern& p = *a.pattern;
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(p.rows()));
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      if (core[k]) columns[i].push_back(p.column[k]);
  BlockCsr result(make_pattern(std::move(columns), 3));
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
      if (!core[k]) continue;
      const Index to = result.pattern->find(i, p.column[k]);
      for (Index r = 0; r < 3; ++r)
        std::copy_n(a.block(i, k) + r * p.width(i), 3,
                    result.block(i, to) + r * result.pattern->width(i));
    }
  return result;
}

void write_stiffness(const fs::path& folder, const ClothModel& cloth, const State& state,
                     ForceClass force_class) {
  std::vector<const ForceModel*> models;
  for (const auto& model : cloth.springs())
    if (model->force_class() == force_class) models.push_back(model.get());
  if (models.empty()) return;
  Assembler assembler(cloth.nodes(), models, std::vector<bool>(models.size(), true));
  ForceRequest request;
  request.x = state.x, request.v = state.v;
  request.matrix_stiffness = 1.0;
  const std::vector<double> no_mass(state.x.size(), 0.0);
  BlockCsr k(assembler.pattern());
  std::vector<Vec3> unused(state.x.size());
  assembler.assemble(std::vector<ForceRequest>(models.size(), request), {no_mass, 0.0, {}, 0.0}, k,
                     unused);
  write_symmetric_matrix(folder / fmt::format("K_{}.mtx", name_of(force_class)), k,
                         fmt::format("stiffness of the {} springs, N/m", name_of(force_class)));
}

// Springs with their damping, and what acts from outside.
std::vector<Vec3> total_force(const ClothModel& cloth, const ExternalForces& external,
                              const State& state) {
  const auto models = cloth.force_models();
  Assembler assembler(cloth.nodes(), models, std::vector<bool>(models.size(), false));
  ForceRequest request;
  request.x = state.x, request.v = state.v;
  BlockCsr unused(assembler.pattern());
  std::vector<Vec3> force(state.x.size());
  assembler.assemble(std::vector<ForceRequest>(models.size(), request),
                     {external.masses(), 1.0, {}, 0.0}, unused, force);
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += external.force()[i];
  return force;
}

void write_external_damping(const fs::path& folder, std::span<const Mat3> damping) {
  if (damping.empty()) return;
  std::vector<MatrixEntry> lower;
  for (Index i = 0; i < static_cast<Index>(damping.size()); ++i)
    for (Index r = 0; r < 3; ++r)
      for (Index c = 0; c <= r; ++c)
        if (damping[i](r, c) != 0.0) lower.push_back({3 * i + r, 3 * i + c, damping[i](r, c)});
  write_symmetric_matrix(folder / "D_external.mtx", 3 * static_cast<Index>(damping.size()), lower,
                         "drag and wind, kg/s");
}

void write_constraints(const fs::path& folder, const ConstraintSet& constraints) {
  std::vector<MatrixEntry> s, u;
  Index column = 0;
  for (Index i = 0; i < constraints.nodes(); ++i) {
    const Mat3 projection = constraints.projection(i);
    const int ndof = constraints.ndof(i);
    for (Index r = 0; r < 3; ++r) {
      for (Index c = 0; c < 3; ++c)
        if (projection(r, c) != 0.0) s.push_back({3 * i + r, 3 * i + c, projection(r, c)});
      for (Index c = 0; c < ndof; ++c)
        if (const double value = constraints.frame(i)(r, c); value != 0.0)
          u.push_back({3 * i + r, column + c, value});
    }
    column += ndof;
  }
  const Index rows = 3 * constraints.nodes();
  write_general_matrix(folder / "S.mtx", rows, rows, s,
                       "projection on the free directions, block diagonal");
  write_general_matrix(folder / "U.mtx", rows, column, u,
                       "orthonormal free directions: U'U = I, UU' = S");
}

// Where springs of a class are split between implicit and explicit, a column tells which is which.
void write_springs(const fs::path& path, const ClothModel& cloth, bool split) {
  std::string text = split ? "i,j,class,rest_length,stiffness,damping,implicit\n"
                           : "i,j,class,rest_length,stiffness,damping\n";
  for (const auto& model : cloth.springs()) {
    const char* end = !split ? "\n" : model->stable_explicitly() ? ",0\n" : ",1\n";
    for (const auto& [i, j, p] : model->springs())
      fmt::format_to(std::back_inserter(text), "{},{},{},{:.17g},{:.17g},{:.17g}{}", i, j,
                     name_of(model->force_class()), p.rest_length, p.stiffness, p.damping, end);
  }
  write_file(path, text);
}

void write_vectors(const fs::path& folder, SceneSimulation& simulation) {
  const State& state = simulation.state();
  const Stepper& stepper = simulation.stepper();
  const LinearSystem system = stepper.system();
  const auto put = [&](const char* name, std::span<const double> values, const char* comment) {
    write_vector(folder / name, values, comment);
  };
  std::vector<double> masses;
  for (const double m : stepper.external().masses()) masses.insert(masses.end(), 3, m);
  put("M.mtx", masses, "mass of each unknown, kg");
  put("b.mtx", system.rhs, "right-hand side as solved, friction included");
  put("z.mtx", system.z, "prescribed part of the unknown");
  put("x.mtx", flat(state.x), "positions at the start of the step, m");
  put("v.mtx", flat(state.v), "velocities at the start of the step, m/s");
  const std::vector<Vec3> force = total_force(simulation.cloth(), stepper.external(), state);
  put("f.mtx", flat(force), "force at the start of the step, N");
  const bool displacement = stepper.integrator().unknown(state) == "dx";
  put("dv.mtx", flat(stepper.unknown()),
      displacement ? "the solution: displacement, m" : "the solution: velocity change, m/s");
  if (displacement) {
    put("x_prev.mtx", flat(state.x_prev), "positions a step earlier, m");
    put("v_prev.mtx", flat(state.v_prev), "velocities a step earlier, m/s");
  }
  if (!system.guess.empty()) put("guess.mtx", system.guess, "initial guess");
  // Not contact().impulses(): those are already the next pass's.
  if (const auto friction = stepper.impulses(); !friction.empty())
    put("friction.mtx", flat(friction), "impulses of sliding friction, N s");
}

}  // namespace

void prepare_dump(const fs::path& folder) {
  if (fs::exists(folder) && !fs::is_directory(folder))
    throw InputError({folder.string()}, "is a file; give a folder for the dump with --out");
  if (fs::exists(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (std::ranges::find(dump_names, entry.path().filename().string()) == std::end(dump_names))
        throw InputError(
            {folder.string()},
            fmt::format(
                "holds '{}', which is no part of a dump; give an empty or new folder with --out",
                entry.path().filename().string()));
  for (const char* name : dump_names) fs::remove(folder / name);
}

void write_dump(const fs::path& folder, SceneSimulation& simulation, const SolveSummary& summary) {
  const ClothModel& cloth = simulation.cloth();
  const LinearSystem system = simulation.stepper().system();
  write_symmetric_matrix(folder / "A.mtx", *system.matrix, "the step's matrix, kg");
  BlockCsr own_core;
  write_symmetric_matrix(folder / "A_core.mtx",
                         core_of(core_matrix(system, own_core), system.core.mask),
                         "the matrix core, kg");
  for (const ForceClass force_class : {ForceClass::stretch, ForceClass::shear, ForceClass::bend})
    write_stiffness(folder, cloth, simulation.state(), force_class);
  write_external_damping(folder, simulation.stepper().external().damping());
  write_constraints(folder, *system.constraints);
  write_vectors(folder, simulation);
  write_springs(folder / "springs.csv", cloth,
                simulation.scene().time.integrator == IntegratorKind::imex_adaptive);
  write_file(folder / "meta.json", dump_meta(simulation, summary));
}

DumpOutcome dump_step(SceneSimulation& simulation, int step, const fs::path& folder,
                      const std::function<void(const StepReport&)>& on_step) {
  prepare_dump(folder);
  DumpOutcome outcome;
  while (simulation.steps_done() < step) {
    if (simulation.steps_done() + 1 == step)
      simulation.on_solved = [&](const SolveSummary& summary) {
        write_dump(folder, simulation, summary);
        outcome.summary = summary;
      };
    StepReport record;
    outcome.status = simulation.step(record);
    simulation.on_solved = {};
    if (!outcome.status.ok()) break;
    if (on_step) on_step(record);
  }
  return outcome;
}

}  // namespace taut
