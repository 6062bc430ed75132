#include "taut/sim/surface_contact.h"

#include <fmt/format.h>

#include <algorithm>

#include "taut/base/error.h"

namespace taut {

namespace {

CollisionSurface surface_of(const ClothModel& cloth, const std::vector<MeshSolid>& solids) {
  std::vector<std::vector<Triangle>> own;
  for (const ClothPart& part : cloth.parts()) {
    const auto all =
        std::span(cloth.surface().triangles).subspan(part.first_triangle, part.triangle_count);
    std::vector<Triangle>& triangles = own.emplace_back(all.begin(), all.end());
    for (Triangle& t : triangles)
      for (Index& node : t) node -= part.first_node;
  }
  std::vector<SurfacePart> parts;
  for (std::size_t c = 0; c < own.size(); ++c)
    parts.push_back({cloth.parts()[c].node_count, own[c], false});
  for (const MeshSolid& solid : solids)
    parts.push_back({solid.vertices(), solid.triangles(), true});
  return join_surfaces(parts);
}

std::vector<CollisionBody> bodies_of(const ClothModel& cloth,
                                     const std::vector<MeshSolid>& solids) {
  std::vector<CollisionBody> bodies;
  for (const ClothPart& part : cloth.parts()) bodies.push_back({part.name});
  for (const MeshSolid& solid : solids)
    bodies.push_back({solid.solid().name, true, solid.solid().thickness, solid.solid().friction});
  return bodies;
}

}  // namespace

SurfaceContact::SurfaceContact(const World& world, ClothModel& cloth)
    : gravity_(world.gravity), nodes_(cloth.nodes()) {
  for (std::size_t k = 0; k < world.solids().size(); ++k)
    if (world.solids()[k].shape == SolidShape::mesh)
      solids_.emplace_back(world.solids()[k], world.surfaces()[k]);
  CollisionSurface surface = surface_of(cloth, solids_);
  ContactOptions options = world.contact;
  std::vector<Vec3> start = cloth.start().x;
  start.resize(static_cast<std::size_t>(surface.vertices));
  place_solids(0.0, start);
  if (options.thickness == 0.0) options.thickness = default_thickness(surface, start);
  const auto masses = cloth.external().masses();
  mass_.assign(masses.begin(), masses.end());
  mass_.resize(start.size(), 0.0);
  contact_ = std::make_unique<ClothContact>(std::move(surface), bodies_of(cloth, solids_), start,
                                            mass_, options);
  inverse_mass_.resize(mass_.size(), 0.0);
  held_.resize(mass_.size(), 1);
  if (options.untangle) untangle_start(world, cloth);
  if (!options.allow_intersections) refuse_intersections(cloth.start().x);
}

bool SurfaceContact::wanted(const World& world) {
  return world.contact.self || std::ranges::any_of(world.solids(), [](const Solid& s) {
           return s.shape == SolidShape::mesh;
         });
}

void SurfaceContact::place_solids(double time, std::vector<Vec3>& x) const {
  std::size_t first = static_cast<std::size_t>(nodes_);
  for (const MeshSolid& solid : solids_) {
    const auto count = static_cast<std::size_t>(solid.vertices());
    solid.positions(time, std::span(x).subspan(first, count));
    first += count;
  }
}

std::string SurfaceContact::places(std::span<const Intersection> found) const {
  constexpr std::size_t most_named = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(found.size(), most_named); ++k)
    text += "\n  " + describe(found[k]);
  if (found.size() > most_named) text += fmt::format("\n  and {} more", found.size() - most_named);
  return text;
}

void SurfaceContact::refuse_intersections(std::span<const Vec3> start) {
  const std::vector<Intersection> found = intersections(0.0, start);
  if (found.empty()) return;
  throw InputError(fmt::format(
      "cloth intersects at the start, at {} places:{}\nMove them apart, let --untangle "
      "(contact.untangle = true) do it, or start as "
      "it is with contact.allow_intersections = true; what has passed through may then stay so",
      found.size(), places(found)));
}

void SurfaceContact::hold_zones(const State& state, double h, ConstraintSet& constraints) const {
  for (std::size_t k = 0; k < kept_.zones.node.size(); ++k) {
    const Index node = kept_.zones.node[k];
    if (constraints.ndof(node) == 0) continue;
    const Vec3 fall = kept_.zones.rides[k] ? Vec3(Vec3::Zero()) : Vec3(h * h * gravity_);
    constraints.fix(node, h * state.v[node] + fall);
  }
}

void SurfaceContact::weigh_nodes(const ConstraintSet& pins) {
  for (Index i = 0; i < nodes_; ++i) {
    held_[i] = pins.ndof(i) == 0;
    inverse_mass_[i] = held_[i] ? 0.0 : 1.0 / mass_[i];
  }
}

Status SurfaceContact::correct(double t, double h, std::span<const Vec3> x0,
                               std::span<const Vec3> v_end, const ConstraintSet& pins,
                               const SolidContact& solids, std::span<Vec3> x_end, bool& changed) {
  weigh_nodes(pins);
  x0_.assign(x0.begin(), x0.end());
  x1_.assign(x_end.begin(), x_end.end());
  for (auto* x : {&x0_, &x1_}) x->resize(mass_.size());
  place_solids(t, x0_);
  place_solids(t + h, x1_);
  lever_ = x0_;
  for (Index i = 0; i < nodes_; ++i) lever_[i] = x_end[i] - h * v_end[i];
  const Status status =
      contact_->resolve({x0_, lever_, inverse_mass_, held_, &solids, h, kept_.forces}, x1_);
  if (!status.ok()) return status;
  for (Index i = 0; i < nodes_; ++i) {
    if (x1_[i] == x_end[i]) continue;
    x_end[i] = x1_[i];
    changed = true;
  }
  return {};
}

void SurfaceContact::keep() {
  const ZoneState held = std::move(kept_.zones);
  kept_ = {{}, contact_->forces()};
  const ZoneState& zones = contact_->zone_state();
  for (std::size_t k = 0; k < zones.node.size(); ++k) {
    if (std::ranges::binary_search(held.node, zones.node[k])) continue;
    kept_.zones.node.push_back(zones.node[k]);
    kept_.zones.rides.push_back(zones.rides[k]);
  }
}

void SurfaceContact::restore(ClothContactState state) {
  const ZoneState& zones = state.zones;
  const bool ordered = std::ranges::is_sorted(zones.node, std::ranges::less_equal{});
  const bool inside = zones.node.empty() || (zones.node.front() >= 0 && zones.node.back() < nodes_);
  if (!ordered || !inside || zones.rides.size() != zones.node.size())
    throw InputError(fmt::format(
        "zones: expected ascending nodes below {}: the checkpoint belongs to another scene",
        nodes_));
  const auto is_vertex = [&](Index v) { return v >= 0 && v < std::ssize(mass_); };
  const auto first_of = [](const PairForce& entry) { return entry.node[0]; };
  if (!std::ranges::all_of(
          state.forces,
          [&](const PairForce& entry) { return std::ranges::all_of(entry.node, is_vertex); }) ||
      !std::ranges::is_sorted(state.forces, {}, first_of))
    throw InputError(fmt::format(
        "forces: expected ascending vertices below {}: the checkpoint belongs to another scene",
        mass_.size()));
  kept_ = std::move(state);
}

std::vector<Vec3> SurfaceContact::positions(double time, std::span<const Vec3> x) const {
  std::vector<Vec3> all(x.begin(), x.end());
  all.resize(mass_.size());
  place_solids(time, all);
  return all;
}

std::vector<Intersection> SurfaceContact::intersections(double time, std::span<const Vec3> x) {
  const std::vector<Vec3> all = positions(time, x);
  return find_intersections(contact_->search().broad_phase(), all);
}

std::string SurfaceContact::describe(const Intersection& intersection) const {
  const CollisionSurface& surface = contact_->surface();
  const EdgeVertices& edge = surface.edges[intersection.edge];
  const Triangle& triangle = surface.triangles[intersection.triangle];
  const auto name = [&](Index vertex) {
    const CollisionBody& body = contact_->bodies()[surface.body[vertex]];
    return fmt::format("{} '{}'", body.is_solid ? "solid" : "cloth", body.name);
  };
  const auto first = [&](Index vertex) {
    return std::ranges::lower_bound(surface.body, surface.body[vertex]) - surface.body.begin();
  };
  return fmt::format("the edge between nodes {} and {} of {} and the triangle {}, {}, {} of {}",
                     edge[0] - first(edge[0]), edge[1] - first(edge[1]), name(edge[0]),
                     triangle[0] - first(triangle[0]), triangle[1] - first(triangle[0]),
                     triangle[2] - first(triangle[0]), name(triangle[0]));
}

}  // namespace taut
