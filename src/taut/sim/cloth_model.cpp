#include "taut/sim/cloth_model.h"

#include "taut/element/cloth_springs.h"
#include "taut/element/explicit_split.h"
#include "taut/mesh/topology.h"

namespace taut {

namespace {

std::vector<double> node_masses(const ClothOptions& cloth) {
  if (!cloth.masses.empty()) return cloth.masses;
  if (cloth.node_mass > 0.0)
    return std::vector<double>(cloth.mesh.positions.size(), cloth.node_mass);
  std::vector<double> masses = vertex_areas(cloth.mesh);
  for (double& m : masses) m *= cloth.density;
  return masses;
}

}  // namespace

ClothModel::ClothModel(const World& world) {
  std::vector<double> masses;
  for (const ClothOptions& cloth : world.cloths()) add_cloth(cloth, masses);
  make_springs(world);
  start_.v.resize(start_.x.size(), Vec3::Zero());
  external_ = std::make_unique<ExternalForces>(std::move(masses), world.gravity, world.wind);
  for (std::size_t c = 0; c < parts_.size(); ++c) {
    const ClothOptions& cloth = world.cloths()[c];
    const ClothPart& part = parts_[c];
    for (Index i = part.first_node; i < part.first_node + part.node_count; ++i) {
      external_->set_drag(i, cloth.drag);
      start_.v[i] = cloth.velocity;
    }
    external_->add_wind_surface(
        std::span(surface_.triangles).subspan(part.first_triangle, part.triangle_count),
        cloth.wind_pressure);
  }
  surface_.positions = start_.x;
  for (const WorldPin& pin : world.pins()) add_pin(pin);
}

void ClothModel::make_springs(const World& world, double explicit_step) {
  springs_.clear();
  for (std::size_t c = 0; c < parts_.size(); ++c) {
    const ClothOptions& cloth = world.cloths()[c];
    const ClothPart& part = parts_[c];
    // Rest lengths are those of the mesh; `start` only says where it begins.
    const auto [nu, nv] = cloth.grid;
    auto springs = nu > 0 ? grid_springs(GridShape{.nu = nu, .nv = nv}, cloth.mesh.positions,
                                         cloth.material, part.first_node, cloth.name)
                          : mesh_springs(cloth.mesh, cloth.material, part.first_node, cloth.name);
    for (auto& model : springs) springs_.push_back(std::move(model));
  }
  if (explicit_step > 0.0) {
    const auto masses = external_->masses();
    springs_ =
        split_by_stability(std::move(springs_), {masses.begin(), masses.end()}, explicit_step);
  }
}

void ClothModel::add_cloth(const ClothOptions& cloth, std::vector<double>& masses) {
  const TriangleMesh& mesh = cloth.mesh;
  const ClothPart part{cloth.name, nodes(), static_cast<Index>(mesh.positions.size()),
                       static_cast<Index>(surface_.triangles.size()),
                       static_cast<Index>(mesh.triangles.size())};
  const std::vector<double> own_masses = node_masses(cloth);
  masses.insert(masses.end(), own_masses.begin(), own_masses.end());
  const std::vector<Vec3>& start = cloth.start.empty() ? mesh.positions : cloth.start;
  start_.x.insert(start_.x.end(), start.begin(), start.end());
  for (const Triangle& t : mesh.triangles)
    surface_.triangles.push_back(
        {t[0] + part.first_node, t[1] + part.first_node, t[2] + part.first_node});
  std::vector<Vec2> texcoords = mesh.texcoords;
  texcoords.resize(mesh.positions.size(), Vec2::Zero());
  surface_.texcoords.insert(surface_.texcoords.end(), texcoords.begin(), texcoords.end());
  parts_.push_back(part);
}

void ClothModel::add_pin(const WorldPin& pin) {
  PinnedNodes pinned;
  pinned.carrier.key_frames = pin.path.key_frames;
  pinned.pivot = pin.path.pivot;
  pinned.release = pin.path.release;
  const ClothPart& part = parts_[static_cast<std::size_t>(pin.cloth.index)];
  for (const Index node : pin.nodes) {
    pinned.nodes.push_back(part.first_node + node);
    pinned.start.push_back(start_.x[part.first_node + node]);
  }
  pins_.push_back(std::move(pinned));
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
