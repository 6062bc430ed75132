#include "taut/results/dump_meta.h"

#include <array>
#include <nlohmann/json.hpp>

#include "taut/base/simd.h"
#include "taut/constraint/constraint_set.h"
#include "taut/contact/solid_contact.h"
#include "taut/sim/cloth_model.h"
#include "taut/solve/linear_system.h"
#include "taut/step/state.h"
#include "taut/step/stepper.h"

namespace taut {

namespace {

using Json = nlohmann::ordered_json;

const char* name_of(Compression c) { return c == Compression::linear ? "linear" : "none"; }
const char* name_of(BendModel b) { return b == BendModel::choi_ko ? "choi_ko" : "linear"; }

Json cloth_json(const Cloth& cloth, const ClothPart& part) {
  const SpringMaterial& m = cloth.material;
  Json json{{"name", part.name},
            {"first_node", part.first_node},
            {"nodes", part.node_count},
            {"k_stretch", m.k_stretch},
            {"k_shear", m.k_shear},
            {"k_bend", m.k_bend},
            {"compression", name_of(m.compression)},
            {"bend_model", name_of(m.bend_model)}};
  if (m.bend_model == BendModel::choi_ko)
    json["bend_cap"] = m.bend_cap > 0.0 ? m.bend_cap : m.k_stretch;
  return json;
}

// The cloths' common word, or "mixed".
template <class Name>
std::string common(const Scene& scene, Name name) {
  const std::string first = name(scene.cloths.front().material);
  for (const Cloth& cloth : scene.cloths)
    if (name(cloth.material) != first) return "mixed";
  return first;
}

}  // namespace

std::string dump_meta(SceneSimulation& simulation, const SolveSummary& summary) {
  const Scene& scene = simulation.scene();
  const State& state = simulation.state();
  const ConstraintSet& constraints = simulation.constraints();
  std::array<Index, 4> nodes_by_ndof{};
  for (const auto ndof : constraints.ndofs()) ++nodes_by_ndof[static_cast<std::size_t>(ndof)];
  Json cloths = Json::array();
  for (std::size_t c = 0; c < scene.cloths.size(); ++c)
    cloths.push_back(cloth_json(scene.cloths[c], simulation.cloth().parts()[c]));
  const Json json{
      {"h", scene.time.step},
      {"integrator", name_of(scene.time.integrator)},
      {"compression",
       common(scene, [](const SpringMaterial& m) { return std::string(name_of(m.compression)); })},
      {"bend_model",
       common(scene, [](const SpringMaterial& m) { return std::string(name_of(m.bend_model)); })},
      {"core", scene.solver.chooses_core() ? "auto" : "stretch"},
      {"core_springs", simulation.stepper().core_springs()},
      {"rho", simulation.stepper().remainder_ratio()},
      {"stiffness", simulation.stepper().system().stiffness},
      {"unknown", simulation.stepper().integrator().unknown(state)},
      {"solver", summary.solver},
      {"tolerance", scene.solver.tolerance},
      {"iterations", summary.iterations},
      {"relative_residual", summary.relative_residual},
      {"stop_value", summary.stop_value},
      {"reordering", scene.solver.reordering},
      {"guess", !simulation.stepper().system().guess.empty()},
      {"title", scene.title},
      {"step", simulation.steps_done() + 1},
      {"time", state.time},
      {"nodes", simulation.cloth().nodes()},
      {"unknowns", 3 * simulation.cloth().nodes()},
      {"free_dofs", constraints.free_dofs()},
      {"nodes_by_ndof", nodes_by_ndof},
      {"contact_passes", simulation.contact().passes()},
      {"cloths", cloths},
      {"instruction_set", instruction_set()},
      {"taut_version", TAUT_VERSION}};
  return json.dump(2) + "\n";
}

}  // namespace taut
