#include "taut/element/cloth_springs.h"

#include <fmt/format.h>

#include "taut/base/error.h"
#include "taut/mesh/topology.h"

namespace taut {

namespace {

SpringLawKind law_of(ForceClass force_class, const SpringMaterial& m) {
  if (force_class == ForceClass::bend)
    return m.bend_model == BendModel::choi_ko ? SpringLawKind::choi_ko : SpringLawKind::linear;
  return m.compression == Compression::linear ? SpringLawKind::linear : SpringLawKind::buckling;
}

SpringParameters parameters_of(ForceClass force_class, const SpringMaterial& m) {
  SpringParameters p;
  switch (force_class) {
    case ForceClass::shear:
      p.stiffness = m.k_shear, p.damping = m.k_damp_shear;
      break;
    case ForceClass::bend:
      p.stiffness = m.k_bend, p.damping = m.k_damp_bend;
      p.cap = m.bend_cap > 0.0 ? m.bend_cap : m.k_stretch;
      break;
    default:
      p.stiffness = m.k_stretch, p.damping = m.k_damp_stretch;
      break;
  }
  return p;
}

class SpringCollector {
 public:
  SpringCollector(ForceClass force_class, std::span<const Vec3> rest,
                  const SpringMaterial& material, Index first_node, const std::string& cloth)
      : class_(force_class),
        rest_(rest),
        law_(law_of(force_class, material)),
        parameters_(parameters_of(force_class, material)),
        first_node_(first_node),
        cloth_(cloth) {}

  void join(Index i, Index j) {
    SpringParameters p = parameters_;
    p.rest_length = (rest_[j] - rest_[i]).norm();
    if (!(p.rest_length > 0.0))
      throw InputError(fmt::format(
          "cloth '{}': vertices {} and {} are joined by a {} spring but lie in the same place "
          "({:.6g}, {:.6g}, {:.6g}); "
          "merge them or move them apart",
          cloth_, i + 1, j + 1, name_of(class_), rest_[i].x(), rest_[i].y(), rest_[i].z()));
    springs_.push_back({first_node_ + i, first_node_ + j, p});
  }
  void deliver_to(std::vector<std::unique_ptr<SpringModel>>& models) {
    if (!springs_.empty())
      models.push_back(std::make_unique<SpringModel>(class_, law_, std::move(springs_)));
  }

 private:
  ForceClass class_;
  std::span<const Vec3> rest_;
  SpringLawKind law_;
  SpringParameters parameters_;
  Index first_node_;
  const std::string& cloth_;
  std::vector<Spring> springs_;
};

}  // namespace

std::vector<std::unique_ptr<SpringModel>> grid_springs(const GridShape& g,
                                                       std::span<const Vec3> rest,
                                                       const SpringMaterial& material,
                                                       Index first_node,
                                                       const std::string& cloth_name) {
  SpringCollector stretch(ForceClass::stretch, rest, material, first_node, cloth_name),
      shear(ForceClass::shear, rest, material, first_node, cloth_name),
      bend(ForceClass::bend, rest, material, first_node, cloth_name);
  for (Index j = 0; j < g.nv; ++j)
    for (Index i = 0; i < g.nu; ++i) {
      const bool right = i + 1 < g.nu, up = j + 1 < g.nv;
      if (right) stretch.join(g.node(i, j), g.node(i + 1, j));
      if (up) stretch.join(g.node(i, j), g.node(i, j + 1));
      if (right && up) {
        shear.join(g.node(i, j), g.node(i + 1, j + 1));
        shear.join(g.node(i + 1, j), g.node(i, j + 1));
      }
      if (i + 2 < g.nu) bend.join(g.node(i, j), g.node(i + 2, j));
      if (j + 2 < g.nv) bend.join(g.node(i, j), g.node(i, j + 2));
    }
  std::vector<std::unique_ptr<SpringModel>> models;
  for (SpringCollector* c : {&stretch, &shear, &bend}) c->deliver_to(models);
  return models;
}

std::vector<std::unique_ptr<SpringModel>> mesh_springs(const TriangleMesh& mesh,
                                                       const SpringMaterial& material,
                                                       Index first_node,
                                                       const std::string& cloth_name) {
  const Topology topology = build_topology(mesh);
  SpringCollector stretch(ForceClass::stretch, mesh.positions, material, first_node, cloth_name),
      bend(ForceClass::bend, mesh.positions, material, first_node, cloth_name);
  for (const Edge& edge : topology.edges) stretch.join(edge.a, edge.b);
  for (const Hinge& hinge : topology.hinges) bend.join(hinge.opposite[0], hinge.opposite[1]);
  std::vector<std::unique_ptr<SpringModel>> models;
  for (SpringCollector* c : {&stretch, &bend}) c->deliver_to(models);
  return models;
}

}  // namespace taut
