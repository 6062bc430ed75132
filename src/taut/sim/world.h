#pragma once
// What is simulated: cloths, pins, solids, air, as arrays and numbers. Files are scene/'s business.
//
//   World world;
//   const auto sheet = world.add_cloth({.mesh = make_grid({.nu = 41, .nv = 41}), .density = 0.15});
//   const auto pin = world.pin(sheet, {0, 40});
//   Simulation simulation(std::move(world));
//
// Units SI. A handle names what was added, in this World and in the Simulation made of it. Nothing
// is judged when it is added: validate() judges all at once, and Simulation calls it.

#include <array>
#include <string>
#include <vector>

#include "taut/contact/contact_options.h"
#include "taut/contact/solid.h"
#include "taut/element/external.h"
#include "taut/element/spring_material.h"
#include "taut/mesh/triangle_mesh.h"

namespace taut {

struct ClothHandle {
  int index = -1;
};
struct PinHandle {
  int index = -1;
};
struct SolidHandle {
  int index = -1;
};

// A piece of cloth. Its mass is given in exactly one of three ways: density, node_mass, masses.
struct ClothOptions {
  TriangleMesh mesh{};           // at rest; texcoords are kept for export
  std::vector<Vec3> start{};     // m, where its nodes start, one each; empty: as at rest
  double density = 0.0;          // kg/m², spread over the triangles' corners
  double node_mass = 0.0;        // kg, of every node
  std::vector<double> masses{};  // kg, one a node
  SpringMaterial material{};
  // Nodes along u and v of a mesh of make_grid: springs are Provot's, 12 a node. Zeros: springs are
  // the mesh's edges, and across them.
  std::array<Index, 2> grid{};
  double drag = 0.0;             // kg/s a node: force -drag (v - wind)
  double wind_pressure = 0.0;    // kg/(m² s): force c A (n·(wind - v)) n on each triangle
  Vec3 velocity = Vec3::Zero();  // m/s at the start
  std::string name{};            // "cloth_0", "cloth_1", ... when empty
};

// How pinned nodes move: carried by the path's displacement since time 0, turned about `pivot`;
// without key frames they stay where they start, or go where the program moves them.
struct PinPath {
  std::vector<KeyFrame> key_frames{};
  Vec3 pivot = Vec3::Zero();  // m
  double release = -1.0;      // s, when they are let go; negative: never
  bool operator==(const PinPath&) const = default;
};

// The surface of a solid that is a mesh, in its own coordinates.
struct SolidSurface {
  TriangleMesh mesh{};
  // m, of a solid that deforms: all vertices at times 0, 1/rate, 2/rate, ...; the last one held
  std::vector<std::vector<Vec3>> samples{};
  double rate = 24.0;  // Hz
};

struct WorldPin {
  ClothHandle cloth;
  std::vector<Index> nodes;  // of the cloth
  PinPath path;
};

class World {
 public:
  Vec3 gravity = Vec3(0, 0, -9.81);  // m/s²
  WindOptions wind;
  ContactOptions contact;

  ClothHandle add_cloth(ClothOptions cloth);
  PinHandle pin(ClothHandle cloth, std::vector<Index> nodes, PinPath path = {});
  SolidHandle add_solid(Solid solid);
  // A solid that is a mesh; the shape of `solid` is set so.
  SolidHandle add_solid(Solid solid, SolidSurface surface);

  void set_material(ClothHandle cloth, const SpringMaterial& material);
  // Key frames, pose and velocities of `motion`, whose shape stays the solid's own.
  void set_motion(SolidHandle solid, const Solid& motion);

  std::span<const ClothOptions> cloths() const { return cloths_; }
  std::span<const WorldPin> pins() const { return pins_; }
  std::span<const Solid> solids() const { return solids_; }
  // One a solid; without triangles where the solid is no mesh.
  std::span<const SolidSurface> surfaces() const { return surfaces_; }

  // Throws InvalidWorld (sim/validator.h) with a sentence for each value that cannot be simulated.
  void validate() const;

 private:
  std::vector<ClothOptions> cloths_;
  std::vector<WorldPin> pins_;
  std::vector<Solid> solids_;
  std::vector<SolidSurface> surfaces_;
};

}  // namespace taut
