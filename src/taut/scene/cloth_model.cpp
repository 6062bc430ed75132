#include "taut/scene/cloth_model.h"

#include <fmt/format.h>

#include <random>

#include "taut/base/error.h"
#include "taut/element/cloth_springs.h"
#include "taut/element/explicit_split.h"
#include "taut/mesh/mesh_sum.h"
#include "taut/mesh/topology.h"
#include "taut/scene/cloth_shape.h"

namespace taut {

namespace {

std::vector<double> node_masses(const Cloth& cloth, const TriangleMesh& mesh) {
  if (cloth.node_mass > 0.0) return std::vector<double>(mesh.positions.size(), cloth.node_mass);
  std::vector<double> masses = vertex_areas(mesh);
  for (double& m : masses) m *= cloth.density;
  return masses;
}

// Uniform in [-1, 1) with the same bits everywhere: std::uniform_real_distribution is left to the
// library's taste.
double symmetric_random(std::mt19937_64& generator) {
  return static_cast<double>(generator() >> 11) * 0x1.0p-52 - 1.0;
}

Index corner_node(const GridShape& g, const std::string& name) {
  return g.node(name.starts_with("u1") ? g.nu - 1 : 0, name.ends_with("v1") ? g.nv - 1 : 0);
}

}  // namespace

std::vector<Index> selected_nodes(const Cloth& cloth, const NodeSelection& where) {
  std::vector<Index> nodes = where.nodes;
  const GridShape& g = cloth.grid;
  for (const std::string& corner : where.corners) nodes.push_back(corner_node(g, corner));
  for (const std::string& edge : where.edges) {
    if (cloth.is_tube) {
      const Index row = edge == "v0" ? 0 : cloth.tube.along - 1;
      for (Index k = 0; k < cloth.tube.around; ++k) nodes.push_back(row * cloth.tube.around + k);
      continue;
    }
    const bool along_v = edge[0] == 'u';
    const Index count = along_v ? g.nv : g.nu;
    const Index fixed = edge[1] == '0' ? 0 : (along_v ? g.nu : g.nv) - 1;
    for (Index k = 0; k < count; ++k)
      nodes.push_back(along_v ? g.node(fixed, k) : g.node(k, fixed));
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

Vec3 PinnedNodes::target(std::size_t k, double time) const {
  if (path.key_frames.empty()) return start[k];
  const Pose now = path.pose(time), origin = path.pose(0.0);
  return pivot + now.rotation * (origin.rotation.conjugate() * (start[k] - pivot)) +
         now.translation - origin.translation;
}

ClothModel::ClothModel(const Scene& scene) {
  std::vector<double> masses;
  for (const Cloth& cloth : scene.cloths) add_cloth(cloth, scene, masses);
  if (scene.time.integrator == IntegratorKind::imex_adaptive)
    springs_ = split_by_stability(std::move(springs_), masses, scene.time.step);
  start_.v.resize(start_.x.size(), Vec3::Zero());
  external_ = std::make_unique<ExternalForces>(
      std::move(masses), scene.gravity,
      WindOptions{scene.wind.velocity, scene.wind.gust, scene.wind.gust_frequency});
  for (std::size_t c = 0; c < parts_.size(); ++c) {
    const Cloth& cloth = scene.cloths[c];
    const ClothPart& part = parts_[c];
    for (Index i = part.first_node; i < part.first_node + part.node_count; ++i) {
      external_->set_drag(i, cloth.drag);
      start_.v[i] = cloth.velocity;
    }
    external_->add_wind_surface(
        std::span(surface_.triangles).subspan(part.first_triangle, part.triangle_count),
        cloth.wind_pressure);
    add_pins(cloth, part);
  }
  surface_.positions = start_.x;
}

void ClothModel::add_cloth(const Cloth& cloth, const Scene& scene, std::vector<double>& masses) {
  TriangleMesh mesh = rest_shape(cloth, scene.folder);
  ClothPart part{cloth.name,
                 nodes(),
                 static_cast<Index>(mesh.positions.size()),
                 static_cast<Index>(surface_.triangles.size()),
                 static_cast<Index>(mesh.triangles.size()),
                 0};
  if (cloth.from_file) part.file_sum = sum_of(mesh);
  // Rest lengths are those of the shape before placement and jitter, which only say where it
  // starts.
  auto springs = cloth.is_grid() ? grid_springs(cloth.grid, mesh.positions, cloth.material,
                                                part.first_node, cloth.name)
                                 : mesh_springs(mesh, cloth.material, part.first_node, cloth.name);
  for (auto& model : springs) springs_.push_back(std::move(model));
  const std::vector<double> own_masses = node_masses(cloth, mesh);
  masses.insert(masses.end(), own_masses.begin(), own_masses.end());
  for (std::size_t i = 0; i < own_masses.size(); ++i)
    if (!(own_masses[i] > 0.0))
      throw InputError(
          fmt::format("cloth '{}': vertex {} has no mass, since it is a corner of no triangle; "
                      "remove it or give node_mass",
                      cloth.name, i + 1));

  std::mt19937_64 generator(cloth.jitter_seed);
  for (const Vec3& rest : mesh.positions) {
    Vec3 x = cloth.placement.to_world(rest);
    if (cloth.jitter > 0.0)
      for (int c = 0; c < 3; ++c) x[c] += cloth.jitter * symmetric_random(generator);
    start_.x.push_back(x);
  }
  for (const Triangle& t : mesh.triangles)
    surface_.triangles.push_back(
        {t[0] + part.first_node, t[1] + part.first_node, t[2] + part.first_node});
  mesh.texcoords.resize(mesh.positions.size(), Vec2::Zero());
  surface_.texcoords.insert(surface_.texcoords.end(), mesh.texcoords.begin(), mesh.texcoords.end());
  parts_.push_back(part);
}

void ClothModel::add_pins(const Cloth& cloth, const ClothPart& part) {
  for (const Pin& pin : cloth.pins) {
    PinnedNodes pinned;
    pinned.path.key_frames = pin.key_frames;
    pinned.pivot = pin.pivot;
    pinned.release = pin.release;
    for (const Index node : selected_nodes(cloth, pin.where)) {
      if (node < 0 || node >= part.node_count)
        throw InputError(pin.nodes_at,
                         fmt::format("cloth '{}': a pin holds node {}, but its nodes are 0 to {}; "
                                     "name nodes from 0, vertex 1 of a file is "
                                     "node 0",
                                     cloth.name, node, part.node_count - 1));
      pinned.nodes.push_back(part.first_node + node);
      pinned.start.push_back(start_.x[part.first_node + node]);
    }
    pins_.push_back(std::move(pinned));
  }
}

void ClothModel::place_start(std::span<const Vec3> x) {
  start_.x.assign(x.begin(), x.end());
  surface_.positions = start_.x;
}

std::vector<const ForceModel*> ClothModel::force_models() const {
  std::vector<const ForceModel*> models;
  for (const auto& model : springs_) models.push_back(model.get());
  return models;
}

std::vector<const SpringModel*> ClothModel::stretch_springs() const {
  std::vector<const SpringModel*> models;
  for (const auto& model : springs_)
    if (model->force_class() == ForceClass::stretch) models.push_back(model.get());
  return models;
}

void ClothModel::constrain_pins(double time, double h, std::span<const Vec3> x,
                                ConstraintSet& constraints) const {
  for (const PinnedNodes& pin : pins_) {
    if (!pin.holds(time)) continue;
    for (std::size_t k = 0; k < pin.nodes.size(); ++k)
      constraints.fix(pin.nodes[k], pin.target(k, time + h) - x[pin.nodes[k]]);
  }
}

}  // namespace taut
