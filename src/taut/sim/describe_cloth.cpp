#include <fmt/format.h>

#include <array>

#include "taut/sim/describe.h"

namespace taut {

namespace {

constexpr std::array compression_names{"none", "linear"};
constexpr std::array bend_model_names{"linear", "choi_ko"};

void describe_material(SchemaVisitor& v, SpringMaterial& m) {
  v.number("k_stretch", m.k_stretch,
           {.doc = "stiffness of a stretch spring", .unit = "N/m", .min = 0, .max = 1e12});
  v.number("k_shear", m.k_shear,
           {.doc = "stiffness of a shear spring", .unit = "N/m", .min = 0, .max = 1e12});
  v.number("k_bend", m.k_bend,
           {.doc = "stiffness of a bend spring; a flexural rigidity in N·m² with `bend_model = "
                   "\"choi_ko\"`",
            .unit = "N/m",
            .min = 0,
            .max = 1e12});
  constexpr const char* damping = "damping along the spring";
  v.number("k_damp_stretch", m.k_damp_stretch,
           {.doc = damping, .unit = "N·s/m", .min = 0, .max = 1e9});
  v.number("k_damp_shear", m.k_damp_shear, {.doc = damping, .unit = "N·s/m", .min = 0, .max = 1e9});
  v.number("k_damp_bend", m.k_damp_bend, {.doc = damping, .unit = "N·s/m", .min = 0, .max = 1e9});
  v.choice("compression", m.compression, compression_names,
           {.doc = "a compressed stretch or shear spring gives way (`none`: the cloth buckles) or "
                   "pushes back (`linear`)"});
  v.choice(
      "bend_model", m.bend_model, bend_model_names,
      {.doc =
           "`linear`: a spring both ways; `choi_ko`: the post-buckling force of Choi & Ko 2002"});
  const bool choi_ko = m.bend_model == BendModel::choi_ko;
  v.number("bend_cap", m.bend_cap,
           {.doc = "slope that caps the buckling force near the rest length; 0: k_stretch",
            .unit = "N/m",
            .min = 0,
            .max = 1e12,
            .applies = choi_ko,
            .only_for = "bend_model choi_ko"});
}

}  // namespace

void describe_cloth_name(SchemaVisitor& v, std::string& name) {
  v.text("name", name,
         {.doc = "for reports and file names, so without `/` and `\\`; `cloth_0`, `cloth_1`, ... "
                 "when not given",
          .unset = name.empty()});
  v.check(
      name.find_first_of("/\\") == std::string::npos, "name",
      fmt::format("'{}' becomes part of file names, where / and \\ part folders: leave them out",
                  name));
}

void describe_cloth_values(SchemaVisitor& v, ClothValues cloth) {
  if (!cloth.has_masses) v.exactly_one(std::array{"node_mass", "density"});
  v.number("node_mass", cloth.node_mass,
           {.doc = "mass of every node",
            .unit = "kg",
            .min = 0,
            .max = 1e6,
            .above_min = true,
            .unset = cloth.node_mass == 0});
  v.number("density", cloth.density,
           {.doc = "mass of an area, spread over the triangles' corners",
            .unit = "kg/m²",
            .min = 0,
            .max = 1e6,
            .above_min = true,
            .unset = cloth.density == 0});
  describe_material(v, cloth.material);
  v.number(
      "drag", cloth.drag,
      {.doc = "force -drag (velocity - wind) on every node", .unit = "kg/s", .min = 0, .max = 1e6});
  v.number("wind_pressure", cloth.wind_pressure,
           {.doc = "force c A (n·(wind - velocity)) n on each triangle of area A and normal n",
            .unit = "kg/(m²·s)",
            .min = 0,
            .max = 1e6});
  v.vector("velocity", cloth.velocity, {.doc = "of every node at the start", .unit = "m/s"});
}

}  // namespace taut
