// What a program changes between the steps of a Simulation, and its snapshots.

#include <fmt/format.h>

#include <algorithm>

#include "taut/base/checksum.h"
#include "taut/sim/describe.h"
#include "taut/sim/simulation_parts.h"
#include "taut/sim/validator.h"

namespace taut {

namespace {

void check_count(const char* what, std::size_t found, std::size_t expected, const char* of) {
  if (found == expected) return;
  throw InputError(fmt::format("{}: {} found, one for each of the {} {} was expected", what, found,
                               expected, of));
}

void check_finite(const char* what, std::span<const Vec3> list) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!list[i].allFinite())
      throw InputError(
          fmt::format("{}: entry {} is ({}, {}, {}), three finite numbers were expected", what, i,
                      list[i].x(), list[i].y(), list[i].z()));
}

void check_handle(const char* what, int index, std::size_t count) {
  if (index >= 0 && static_cast<std::size_t>(index) < count) return;
  throw InputError(
      fmt::format("there is no {} of handle {}: this simulation has {}; use what add_cloth, pin or "
                  "add_solid of "
                  "its World returned",
                  what, index, count));
}

template <class Describe>
void judge(const std::string& path, Describe&& describe) {
  Validator v;
  v.inside(path, [&] { describe(v); });
  v.finish();
}

std::uint64_t sum_of(const World& world) {
  Checksum sum;
  const auto add = [&](const TriangleMesh& mesh) {
    sum.add_items(std::span<const Vec3>(mesh.positions));
    sum.add_items(std::span<const Triangle>(mesh.triangles));
  };
  for (const ClothOptions& cloth : world.cloths()) {
    add(cloth.mesh);
    sum.add_items(std::span<const double>(cloth.masses));
    const double numbers[] = {cloth.density, cloth.node_mass, cloth.drag, cloth.wind_pressure};
    sum.add_items(std::span<const double>(numbers));
    sum.add_items(std::span<const Index>(cloth.grid));
  }
  for (std::size_t s = 0; s < world.solids().size(); ++s) {
    const Solid& solid = world.solids()[s];
    const double numbers[] = {static_cast<double>(solid.shape), solid.radius, solid.height,
                              solid.friction, solid.thickness};
    sum.add_items(std::span<const double>(numbers));
    sum.add_items(std::span<const Vec3>(&solid.size, 1));
    add(world.surfaces()[s].mesh);
  }
  return sum.value();
}

}  // namespace

const ClothPart& Simulation::checked(ClothHandle cloth) const {
  check_handle("cloth", cloth.index, parts_->cloth.parts().size());
  return parts_->cloth.parts()[static_cast<std::size_t>(cloth.index)];
}

PinnedNodes& Simulation::checked(PinHandle pin) {
  check_handle("pin", pin.index, parts_->cloth.pins().size());
  return parts_->cloth.pins()[static_cast<std::size_t>(pin.index)];
}

std::size_t Simulation::checked(SolidHandle solid) const {
  check_handle("solid", solid.index, parts_->world.solids().size());
  return static_cast<std::size_t>(solid.index);
}

std::span<const Vec3> Simulation::positions(ClothHandle cloth) const {
  return part(cloth, parts_->state.x);
}

std::span<const Vec3> Simulation::velocities(ClothHandle cloth) const {
  return part(cloth, parts_->state.v);
}

std::span<const Vec3> Simulation::part(ClothHandle cloth, const std::vector<Vec3>& field) const {
  const ClothPart& p = checked(cloth);
  return std::span(field).subspan(static_cast<std::size_t>(p.first_node),
                                  static_cast<std::size_t>(p.node_count));
}

// ---- air, forces, material

void Simulation::set_gravity(const Vec3& gravity) {
  Vec3 copy = gravity;
  judge("", [&](Validator& v) { describe_gravity(v, copy); });
  parts_->world.gravity = gravity;
  parts_->stepper->external().set_gravity(gravity);
  if (parts_->surface_contact) parts_->surface_contact->set_gravity(gravity);
}

void Simulation::set_wind(const WindOptions& wind) {
  WindOptions copy = wind;
  judge("wind.", [&](Validator& v) { describe_wind(v, copy); });
  parts_->world.wind = wind;
  parts_->stepper->external().set_wind(wind);
}

void Simulation::set_material(ClothHandle cloth, const SpringMaterial& material) {
  checked(cloth);
  ClothOptions copy = parts_->world.cloths()[static_cast<std::size_t>(cloth.index)];
  copy.material = material;
  judge(fmt::format("cloth.{}.", cloth.index), [&](Validator& v) {
    describe_cloth_values(v, {copy.node_mass, copy.density, copy.material, copy.drag,
                              copy.wind_pressure, copy.velocity, !copy.masses.empty()});
  });
  parts_->world.set_material(cloth, material);
  const bool splits = parts_->options.integrator == IntegratorKind::imex_adaptive;
  parts_->cloth.make_springs(parts_->world, splits ? parts_->clock.longest : 0.0);
  make_stepper();
}

void Simulation::set_velocities(ClothHandle cloth, std::span<const Vec3> v) {
  const ClothPart& p = checked(cloth);
  check_count("velocities", v.size(), static_cast<std::size_t>(p.node_count), "nodes");
  check_finite("velocities", v);
  std::ranges::copy(v, parts_->state.v.begin() + p.first_node);
  parts_->stepper->start_afresh(parts_->state);
}

void Simulation::set_forces(ClothHandle cloth, std::span<const Vec3> force) {
  const ClothPart& p = checked(cloth);
  check_count("forces", force.size(), static_cast<std::size_t>(p.node_count), "nodes");
  check_finite("forces", force);
  const auto before = parts_->stepper->external().applied();
  std::vector<Vec3> all(before.begin(), before.end());
  all.resize(static_cast<std::size_t>(parts_->cloth.nodes()), Vec3::Zero());
  std::ranges::copy(force, all.begin() + p.first_node);
  parts_->stepper->external().set_applied(std::move(all));
}

// ---- pins

void Simulation::move(PinHandle pin, const Vec3& displacement) {
  PinnedNodes& pinned = checked(pin);
  check_finite("displacement", {&displacement, 1});
  std::vector<Vec3> places = pinned.start;
  for (Vec3& x : places) x += displacement;
  pinned.move_to(std::move(places), parts_->state.time);
}

void Simulation::place(PinHandle pin, std::span<const Vec3> places) {
  PinnedNodes& pinned = checked(pin);
  check_count("places", places.size(), pinned.nodes.size(), "pinned nodes");
  check_finite("places", places);
  pinned.move_to({places.begin(), places.end()}, parts_->state.time);
}

void Simulation::release(PinHandle pin) { checked(pin).held = false; }

void Simulation::hold(PinHandle pin) {
  PinnedNodes& pinned = checked(pin);
  PinnedNodes anew;
  anew.nodes = pinned.nodes;
  for (const Index node : anew.nodes) anew.start.push_back(parts_->state.x[node]);
  pinned = std::move(anew);
}

PinHandle Simulation::pin(ClothHandle cloth, std::vector<Index> nodes) {
  const ClothPart& p = checked(cloth);
  PinnedNodes pinned;
  if (nodes.empty()) throw InputError("pin: no nodes given; name at least one, from 0");
  for (const Index node : nodes) {
    if (node < 0 || node >= p.node_count)
      throw InputError(fmt::format(
          "pin: it holds node {}, but the nodes of cloth '{}' are 0 to {}; name nodes from 0", node,
          p.name, p.node_count - 1));
    pinned.nodes.push_back(p.first_node + node);
    pinned.start.push_back(parts_->state.x[p.first_node + node]);
  }
  parts_->cloth.pins().push_back(std::move(pinned));
  return {static_cast<int>(parts_->cloth.pins().size()) - 1};
}

// ---- solids

void Simulation::move(SolidHandle solid, const Pose& pose) {
  const std::size_t k = checked(solid);
  Pose copy = pose;
  judge(fmt::format("solid.{}.", k), [&](Validator& v) { describe_pose(v, copy, true, ""); });
  parts_->solid_targets[k] = pose;
  parts_->awaits_step[k] = 1;
}

MeshSolid& Simulation::mesh_solid(std::size_t solid) {
  std::size_t mesh = 0;
  for (std::size_t k = 0; k < solid; ++k)
    mesh += parts_->world.solids()[k].shape == SolidShape::mesh ? 1u : 0u;
  return parts_->surface_contact->solids()[mesh];
}

void Simulation::deform(SolidHandle solid, std::span<const Vec3> shape) {
  const std::size_t k = checked(solid);
  if (parts_->world.solids()[k].shape != SolidShape::mesh)
    throw InputError(fmt::format("solid '{}' is no mesh: only a mesh can be deformed",
                                 parts_->world.solids()[k].name));
  check_count("shape", shape.size(), static_cast<std::size_t>(mesh_solid(k).vertices()),
              "vertices");
  check_finite("shape", shape);
  parts_->shape_targets[k].assign(shape.begin(), shape.end());
}

void Simulation::set_solid(std::size_t solid) {
  const Solid& s = parts_->world.solids()[solid];
  for (std::size_t k = 0; k < parts_->variant_of.size(); ++k)
    if (parts_->variant_of[k] == static_cast<int>(solid)) parts_->contact.set_solid(k, s);
  if (s.shape == SolidShape::mesh) mesh_solid(solid).set_motion(s);
}

// What waits for a step goes from where it is to its target within this one.
void Simulation::begin_moves(double h) {
  const double now = parts_->state.time;
  for (PinnedNodes& pin : parts_->cloth.pins()) pin.begin_step(now, h);
  for (std::size_t k = 0; k < parts_->awaits_step.size(); ++k) {
    if (parts_->awaits_step[k]) {
      Solid moved = parts_->world.solids()[k];
      moved.key_frames = {{now, moved.pose(now)}, {now + h, parts_->solid_targets[k]}};
      parts_->world.set_motion({static_cast<int>(k)}, moved);
      set_solid(k);
    }
    if (!parts_->shape_targets[k].empty())
      mesh_solid(k).deform(parts_->shape_targets[k], now, now + h);
  }
}

void Simulation::end_moves() {
  for (PinnedNodes& pin : parts_->cloth.pins()) pin.end_step();
  std::ranges::fill(parts_->awaits_step, 0);
  for (auto& shape : parts_->shape_targets) shape.clear();
}

// ---- snapshots

Snapshot Simulation::save() const { return {to_bytes(full_state())}; }

void Simulation::load(const Snapshot& snapshot) {
  set_full_state(state_from(snapshot.bytes, "the snapshot"));
}

SimulationState Simulation::full_state() const {
  SimulationState s;
  s.world = sum_of(parts_->world);
  s.clock = parts_->clock;
  s.state = parts_->state;
  s.contacts = parts_->contact.state();
  if (parts_->surface_contact) s.surface_contact = parts_->surface_contact->state();
  s.solver_memory = parts_->stepper->solver().memory();
  s.gravity = parts_->world.gravity;
  s.wind = parts_->world.wind;
  const auto applied = parts_->stepper->external().applied();
  s.applied.assign(applied.begin(), applied.end());
  for (const ClothOptions& cloth : parts_->world.cloths()) s.materials.push_back(cloth.material);
  s.pins.assign(parts_->cloth.pins().begin(), parts_->cloth.pins().end());
  s.solids.assign(parts_->world.solids().begin(), parts_->world.solids().end());
  s.solid_targets = parts_->solid_targets;
  s.awaits_step = parts_->awaits_step;
  if (parts_->surface_contact)
    for (const MeshSolid& solid : std::as_const(*parts_->surface_contact).solids())
      s.deformations.push_back(solid.deformation());
  s.shape_targets = parts_->shape_targets;
  return s;
}

void Simulation::set_full_state(const SimulationState& s) {
  const std::size_t solids = parts_->world.solids().size(),
                    meshes = parts_->surface_contact ? parts_->surface_contact->solids().size() : 0;
  if (s.world != sum_of(parts_->world) ||
      s.state.x.size() != static_cast<std::size_t>(parts_->cloth.nodes()) ||
      s.materials.size() != parts_->world.cloths().size() || s.solids.size() != solids ||
      s.solid_targets.size() != solids || s.awaits_step.size() != solids ||
      s.shape_targets.size() != solids || s.deformations.size() != meshes)
    throw InputError(
        "the snapshot belongs to another world: load it into a simulation of the same meshes, "
        "masses and solids");
  const SimulationState before = full_state();
  try {
    take(s);
  } catch (const InputError&) {
    take(before);  // all or nothing
    throw;
  }
}

void Simulation::take(const SimulationState& s) {
  bool other_material = false;
  for (std::size_t c = 0; c < s.materials.size(); ++c) {
    other_material = other_material || !(s.materials[c] == parts_->world.cloths()[c].material);
    parts_->world.set_material({static_cast<int>(c)}, s.materials[c]);
  }
  // An adaptive split, too, is of the longest step so far.
  const bool splits = parts_->options.integrator == IntegratorKind::imex_adaptive &&
                      s.clock.longest != parts_->clock.longest;
  if (other_material || splits) {
    const bool adaptive = parts_->options.integrator == IntegratorKind::imex_adaptive;
    parts_->cloth.make_springs(parts_->world, adaptive ? s.clock.longest : 0.0);
    parts_->clock.longest = s.clock.longest;
    make_stepper();
  } else if (s.clock.longest > 0.0 && s.clock.longest != parts_->clock.longest) {
    parts_->stepper->choose_core(s.clock.longest);
  }
  parts_->clock = s.clock;
  parts_->state = s.state;
  parts_->stepper->solver().restore_memory(s.solver_memory);
  parts_->contact.restore(s.contacts);
  if (parts_->surface_contact) parts_->surface_contact->restore(s.surface_contact);
  set_gravity(s.gravity);
  set_wind(s.wind);
  parts_->stepper->external().set_applied(s.applied);
  parts_->cloth.pins() = s.pins;
  parts_->solid_targets = s.solid_targets;
  parts_->awaits_step = s.awaits_step;
  parts_->shape_targets = s.shape_targets;
  std::size_t mesh = 0;
  for (std::size_t k = 0; k < s.solids.size(); ++k) {
    parts_->world.set_motion({static_cast<int>(k)}, s.solids[k]);
    set_solid(k);
    if (parts_->world.solids()[k].shape == SolidShape::mesh && parts_->surface_contact)
      parts_->surface_contact->solids()[mesh].set_deformation(s.deformations[mesh]), ++mesh;
  }
}

}  // namespace taut
